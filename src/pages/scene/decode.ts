import type { ArrayReference, ExactPointsReference, PointsReference, SceneRecord, ValuesReference } from "./scene";

/** The record of a scene with the bytes that its references point into. */
export interface Scene {
  record: SceneRecord;
  bytes: Uint8Array;
}

const unknown_code = 65535;

function from_base64(text: string): Uint8Array {
  const binary = atob(text.trim());
  const bytes = new Uint8Array(binary.length);
  for (let i = 0; i < binary.length; ++i) bytes[i] = binary.charCodeAt(i);
  return bytes;
}

async function inflated(bytes: Uint8Array): Promise<Uint8Array> {
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("deflate"));
  return new Uint8Array(await new Response(stream).arrayBuffer());
}

/** Base64 of deflated: length of the record (4 bytes, little-endian), the record as JSON, the arrays. */
export async function decode_scene(text: string): Promise<Scene> {
  const all = await inflated(from_base64(text));
  const length = new DataView(all.buffer, all.byteOffset).getUint32(0, true);
  const record = JSON.parse(new TextDecoder().decode(all.subarray(4, 4 + length))) as SceneRecord;
  return { record, bytes: all.subarray(4 + length) };
}

/** Undoes byte planes, zigzag and differences. */
export function unpacked(bytes: Uint8Array, reference: ArrayReference): Uint32Array {
  const { at, count, bits } = reference;
  const values = new Uint32Array(count);
  const planes = bits / 8;
  const mask = bits === 16 ? 0xffff : 0xffffffff;
  let previous = 0;
  for (let i = 0; i < count; ++i) {
    let code = 0;
    for (let plane = 0; plane < planes; ++plane) code |= bytes[at + plane * count + i] << (8 * plane);
    code >>>= 0;
    const difference = (code >>> 1) ^ -(code & 1);
    previous = ((previous + difference) & mask) >>> 0;
    values[i] = previous;
  }
  return values;
}

/** x, y, z of one point after the other. */
export function unpacked_points(bytes: Uint8Array, reference: PointsReference): Float32Array {
  const codes = unpacked(bytes, reference.array);
  const count = codes.length / 3;
  const points = new Float32Array(codes.length);
  for (let axis = 0; axis < 3; ++axis) {
    const step = (reference.max[axis] - reference.min[axis]) / 65535;
    for (let i = 0; i < count; ++i) points[3 * i + axis] = reference.min[axis] + step * codes[axis * count + i];
  }
  return points;
}

/** x, y, z of one point after the other. */
export function unpacked_exact_points(bytes: Uint8Array, reference: ExactPointsReference): Float64Array {
  const low = unpacked(bytes, reference.low), high = unpacked(bytes, reference.high);
  const points = new Float64Array(low.length), count = low.length / 3;
  const words = new DataView(points.buffer);
  for (let k = 0; k < low.length; ++k) {
    const at = 8 * (3 * (k % count) + Math.floor(k / count));
    words.setUint32(at, low[k], true);
    words.setUint32(at + 4, high[k], true);
  }
  return points;
}

/** NaN where nothing is known. */
export function unpacked_values(bytes: Uint8Array, reference: ValuesReference): Float32Array {
  const codes = unpacked(bytes, reference.array);
  const step = (reference.max - reference.min) / 65534;
  return Float32Array.from(codes, (code) => (code === unknown_code ? NaN : reference.min + step * code));
}
