/** Maps that stay readable without red-green vision and in grey. */

type Colour = [number, number, number];

// Viridis (Smith and van der Walt, 2015) and "vik" (Crameri, 2018) at equal distances; between them colours are straight.
const magnitude: Colour[] = [
  [68, 1, 84], [72, 40, 120], [62, 74, 137], [49, 104, 142], [38, 130, 142],
  [31, 158, 137], [53, 183, 121], [110, 206, 88], [181, 222, 43], [253, 231, 37],
];
const diverging: Colour[] = [
  [0, 18, 97], [3, 67, 128], [55, 125, 168], [147, 185, 208], [236, 229, 224],
  [220, 172, 140], [193, 111, 65], [138, 48, 8], [89, 0, 8],
];

/** What is drawn where a value is not known. */
export const unknown_colour: Colour = [150, 150, 150];

/** `size` colours, four bytes each. */
export function colour_table(is_diverging: boolean, size = 256): Uint8Array {
  const stops = is_diverging ? diverging : magnitude;
  const table = new Uint8Array(4 * size);
  for (let i = 0; i < size; ++i) {
    const at = (i / (size - 1)) * (stops.length - 1);
    const low = Math.min(Math.floor(at), stops.length - 2);
    for (let channel = 0; channel < 3; ++channel)
      table[4 * i + channel] = stops[low][channel] + (at - low) * (stops[low + 1][channel] - stops[low][channel]);
    table[4 * i + 3] = 255;
  }
  return table;
}

/** A colour as CSS, for a fraction in [0, 1]. */
export function colour_at(table: Uint8Array, fraction: number): string {
  const i = 4 * Math.round(Math.min(1, Math.max(0, fraction)) * (table.length / 4 - 1));
  return `rgb(${table[i]} ${table[i + 1]} ${table[i + 2]})`;
}
