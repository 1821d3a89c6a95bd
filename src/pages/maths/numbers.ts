/** Four significant digits, without trailing zeros; an em dash for what is not known. */
export function shown(value: number | null | undefined, unit = ""): string {
  if (value === null || value === undefined || Number.isNaN(value)) return "–";
  const text = Number.isInteger(value) && Math.abs(value) < 1e15 ? value.toLocaleString("en") : short(value);
  return unit === "" ? text : `${text} ${unit}`;
}

function short(value: number): string {
  const size = Math.abs(value);
  return size !== 0 && (size < 1e-3 || size >= 1e6) ? value.toExponential(2) : String(Number(value.toPrecision(4)));
}

/** The value below which the given fraction of the finite values lies (nearest rank). */
export function quantile(sorted: Float32Array, fraction: number): number {
  if (sorted.length === 0) return NaN;
  const rank = Math.ceil(fraction * sorted.length) - 1;
  return sorted[Math.min(sorted.length - 1, Math.max(0, rank))];
}

export function sorted_finite(values: Float32Array): Float32Array {
  return values.filter((value) => !Number.isNaN(value)).sort();
}

/** How many of the sorted values fall into each of `bins` equal pieces of [low, high]; ends hold what lies beyond. */
export function histogram(sorted: Float32Array, low: number, high: number, bins: number): number[] {
  const counts = new Array<number>(bins).fill(0);
  const scale = high > low ? bins / (high - low) : 0;
  for (const value of sorted) counts[Math.min(bins - 1, Math.max(0, Math.floor((value - low) * scale)))] += 1;
  return counts;
}
