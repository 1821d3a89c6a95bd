import { choice, element, row } from "../controls/elements";
import { unpacked, unpacked_points, unpacked_values } from "../scene/decode";
import type { PatternRecord, PieceRecord } from "../scene/scene";

const red_strain = 0.05; // drawn in full red, as in the files of patterns
const spot = 0.01; // of the sheet: radius of what is shown on the product
const highlight_colour = "#1d6fd1";

interface Piece {
  name: string;
  places: Float32Array;
  faces: Uint32Array;
  outline: Uint32Array;
  product_faces: Uint32Array;
  strain: Float32Array;
}

interface Pattern {
  mesh: number;
  pieces: Piece[];
  /** Of every face of the product: the pieces and faces there. */
  at_product: Map<number, [piece: number, face: number][]>;
  low: [number, number];
  high: [number, number];
}

function piece_of(record: PieceRecord, bytes: Uint8Array): Piece {
  return {
    name: record.name,
    places: unpacked_points(bytes, record.places),
    faces: unpacked(bytes, record.faces),
    outline: unpacked(bytes, record.outline),
    product_faces: unpacked(bytes, record.product_faces),
    strain: unpacked_values(bytes, record.strain),
  };
}

function pattern_of({ mesh, pieces: records }: PatternRecord, bytes: Uint8Array): Pattern {
  const pieces = records.map((record) => piece_of(record, bytes));
  const at_product: Pattern["at_product"] = new Map();
  const low: [number, number] = [Infinity, Infinity], high: [number, number] = [-Infinity, -Infinity];
  pieces.forEach((piece, p) => {
    piece.product_faces.forEach((face, f) => at_product.set(face, [...(at_product.get(face) ?? []), [p, f]]));
    for (let i = 0; i < piece.places.length; ++i) {
      if (i % 3 === 2) continue;
      low[i % 3] = Math.min(low[i % 3], piece.places[i]);
      high[i % 3] = Math.max(high[i % 3], piece.places[i]);
    }
  });
  return { mesh, pieces, at_product, low, high };
}

/** The flat pieces of a product, coloured by strain; what is pointed at here is shown on the product, and back. */
export class PiecesPanel {
  readonly body: HTMLElement;
  private readonly patterns: Pattern[];
  private shown = 0;
  private readonly canvas = element("canvas", { class: "pieces", role: "img", "aria-label": "The flat pieces, coloured by strain" });
  private readonly text = element("p", { class: "soft", role: "status", "aria-label": "Piece" });
  /** Without what is highlighted. */
  private picture: HTMLCanvasElement | null = null;
  private highlighted: [number, number][] = [];

  /** hovered: faces of a mesh, or none. */
  constructor(records: PatternRecord[], bytes: Uint8Array, names: string[], private readonly hovered: (mesh: number, faces: number[]) => void) {
    this.patterns = records.map((record) => pattern_of(record, bytes));
    const options = records.map((record, i) => ({ value: String(i), label: names[record.mesh] }));
    const which = records.length < 2 ? null : row("Product", choice(options, "0", (value) => this.choose(Number(value)), "Product whose pieces are shown"));
    this.body = element("section", {}, which, this.canvas, this.text,
      element("p", { class: "soft" }, "Point at a piece to see its place on the product, and at the product to see its place in a piece. White: no strain; red: 5 % and more."));
    this.canvas.addEventListener("pointermove", (event) => this.point_at(event.offsetX, event.offsetY));
    this.canvas.addEventListener("pointerleave", () => this.leave());
    new ResizeObserver(() => this.redraw()).observe(this.canvas);
  }

  /** What the pointer meets on a mesh. */
  show(mesh: number, face: number | null): void {
    const wanted = face === null ? -1 : this.patterns.findIndex((pattern) => pattern.mesh === mesh);
    if (wanted >= 0 && wanted !== this.shown) this.choose(wanted);
    this.highlight(wanted < 0 || face === null ? [] : (this.pattern.at_product.get(face) ?? []));
  }

  /** For tests: the middle of the face of a piece that a face of the product became, in pixels of the canvas. */
  pixel_of(mesh: number, face: number): [number, number] | null {
    const pattern = this.patterns.find((each) => each.mesh === mesh);
    const [at] = pattern?.at_product.get(face) ?? [];
    if (pattern === undefined || at === undefined) return null;
    const corners = this.corners(pattern.pieces[at[0]], at[1]).map((corner) => this.pixel(...corner));
    return [0, 1].map((axis) => (corners[0][axis] + corners[1][axis] + corners[2][axis]) / 3) as [number, number];
  }

  /** For tests: faces of the product, with the names of the pieces that they became a part of. */
  get highlights(): { piece: string; product_face: number }[] {
    return this.highlighted.map(([piece, face]) => ({ piece: this.pattern.pieces[piece].name, product_face: this.pattern.pieces[piece].product_faces[face] }));
  }

  private get pattern(): Pattern {
    return this.patterns[this.shown];
  }

  private choose(index: number): void {
    this.shown = index;
    this.highlighted = [];
    this.redraw();
  }

  private leave(): void {
    this.highlight([]);
    this.hovered(this.pattern.mesh, []);
  }

  private point_at(x: number, y: number): void {
    const found = this.face_at(x, y);
    this.highlight(found === null ? [] : [found]);
    this.hovered(this.pattern.mesh, found === null ? [] : this.product_faces_around(...found));
  }

  private highlight(faces: [number, number][]): void {
    this.highlighted = faces;
    const [first] = faces;
    this.text.textContent = first === undefined ? "" : `${this.pattern.pieces[first[0]].name}: strain ${(100 * this.pattern.pieces[first[0]].strain[first[1]]).toPrecision(2)} %`;
    this.draw();
  }

  /** The face and those near it: one alone is hardly seen on the product. */
  private product_faces_around(piece: number, face: number): number[] {
    const { low, high } = this.pattern, whole = this.pattern.pieces[piece];
    const middle = (each: number): [number, number] => {
      const corners = this.corners(whole, each);
      return [0, 1].map((axis) => (corners[0][axis] + corners[1][axis] + corners[2][axis]) / 3) as [number, number];
    };
    const radius = spot * Math.hypot(high[0] - low[0], high[1] - low[1]), [x, y] = middle(face);
    const around = [whole.product_faces[face]];
    whole.product_faces.forEach((number, each) => {
      const [u, v] = middle(each);
      if (each !== face && Math.hypot(u - x, v - y) < radius) around.push(number);
    });
    return around;
  }

  // ---- places

  private get scale(): number {
    const { low, high } = this.pattern;
    return Math.min(this.canvas.clientWidth / (high[0] - low[0]), this.canvas.clientHeight / (high[1] - low[1]));
  }

  private pixel(x: number, y: number): [number, number] {
    const { low, high } = this.pattern;
    return [(x - low[0]) * this.scale, (high[1] - y) * this.scale];
  }

  private corners(piece: Piece, face: number): [number, number][] {
    return [0, 1, 2].map((k) => {
      const at = 3 * piece.faces[3 * face + k];
      return [piece.places[at], piece.places[at + 1]];
    });
  }

  private face_at(x: number, y: number): [number, number] | null {
    const at = [this.pattern.low[0] + x / this.scale, this.pattern.high[1] - y / this.scale];
    for (let p = 0; p < this.pattern.pieces.length; ++p) {
      const piece = this.pattern.pieces[p];
      for (let f = 0; 3 * f < piece.faces.length; ++f) {
        const [a, b, c] = this.corners(piece, f);
        const side = (u: [number, number], w: [number, number]): boolean => (w[0] - u[0]) * (at[1] - u[1]) - (w[1] - u[1]) * (at[0] - u[0]) >= 0;
        if (side(a, b) && side(b, c) && side(c, a)) return [p, f];
      }
    }
    return null;
  }

  // ---- drawing

  private redraw(): void {
    this.picture = null;
    this.draw();
  }

  private draw(): void {
    const width = this.canvas.clientWidth, height = this.canvas.clientHeight, ratio = window.devicePixelRatio;
    if (width === 0 || height === 0) return;
    if (this.picture === null) {
      this.picture = document.createElement("canvas");
      for (const canvas of [this.canvas, this.picture]) [canvas.width, canvas.height] = [Math.round(ratio * width), Math.round(ratio * height)];
      const drawing = this.picture.getContext("2d") as CanvasRenderingContext2D;
      drawing.scale(ratio, ratio);
      for (const piece of this.pattern.pieces) this.draw_piece(drawing, piece);
    }
    const context = this.canvas.getContext("2d") as CanvasRenderingContext2D;
    context.setTransform(1, 0, 0, 1, 0, 0);
    context.clearRect(0, 0, this.canvas.width, this.canvas.height);
    context.drawImage(this.picture, 0, 0);
    context.scale(ratio, ratio);
    context.fillStyle = context.strokeStyle = highlight_colour;
    context.lineWidth = 4; // a face may be smaller than a pixel
    context.lineJoin = "round";
    for (const [piece, face] of this.highlighted) {
      this.trace(context, this.corners(this.pattern.pieces[piece], face));
      context.fill();
      context.stroke();
    }
  }

  private draw_piece(context: CanvasRenderingContext2D, piece: Piece): void {
    for (let f = 0; 3 * f < piece.faces.length; ++f) {
      const pale = Math.round(255 * (1 - Math.min(1, piece.strain[f] / red_strain)));
      context.fillStyle = context.strokeStyle = `rgb(255,${pale},${pale})`;
      context.lineWidth = 0.7;
      this.trace(context, this.corners(piece, f));
      context.fill();
      context.stroke();
    }
    const outline = [...piece.outline].map((vertex): [number, number] => [piece.places[3 * vertex], piece.places[3 * vertex + 1]]);
    context.strokeStyle = "#111827";
    context.lineWidth = 1;
    this.trace(context, outline);
    context.stroke();
    const middle = [0, 1].map((axis) => outline.reduce((sum, point) => sum + point[axis], 0) / outline.length);
    const across = outline.map(([x]) => x), width = this.scale * (Math.max(...across) - Math.min(...across));
    context.fillStyle = "#111827";
    context.font = "11px sans-serif";
    context.textAlign = "center";
    if (context.measureText(piece.name).width < width) context.fillText(piece.name, ...this.pixel(middle[0], middle[1]));
  }

  private trace(context: CanvasRenderingContext2D, points: [number, number][]): void {
    context.beginPath();
    for (const point of points) context.lineTo(...this.pixel(...point));
    context.closePath();
  }
}
