// Figures as people read them: names in words, units, and at most four digits that matter.

/** Endings of names, with their units and a factor. */
const UNITS = /** @type {const} */ ([
  ["_mm_per_min", "mm/min"], ["_mm_per_s2", "mm/s²"], ["_mm_per_s3", "mm/s³"], ["_mm_per_s", "mm/s"],
  ["_deg_per_s", "°/s"], ["_per_mm", "1/mm"], ["_mm3", "mm³"], ["_mm2", "mm²"], ["_mm", "mm"], ["_deg", "°"], ["_rpm", "1/min"],
  ["_s", "s"], ["_percent", "%"],
]);

/** The unit that a name ends with; an empty text without one. @param {string} name */
export function unitOf(name) {
  return UNITS.find(([ending]) => name.endsWith(ending))?.[1] ?? "";
}

/** A name in words, without its unit. @param {string} name */
export function wordsOf(name) {
  const ending = UNITS.find(([ending]) => name.endsWith(ending))?.[0] ?? "";
  const words = name.slice(0, name.length - ending.length).replace(/^n_/, "number of ").replaceAll("_", " ").trim();
  return words === "" ? name : words.charAt(0).toUpperCase() + words.slice(1);
}

/** A number with four digits that matter. @param {number} value */
export function digits(value) {
  if (!Number.isFinite(value)) return String(value);
  if (Number.isInteger(value)) return value.toLocaleString("en");
  const size = Math.abs(value);
  if (size >= 10_000) return Math.round(value).toLocaleString("en");
  if (size < 1e-4) return value.toExponential(2);
  const after = Math.min(6, Math.max(0, 3 - Math.floor(Math.log10(size))));
  return String(Number(value.toFixed(after)));
}

/** A time in words. @param {number} seconds */
export function clock(seconds) {
  const whole = Math.floor(seconds);
  const two = (/** @type {number} */ n) => String(n).padStart(2, "0");
  const [hours, minutes] = [Math.floor(whole / 3600), Math.floor(whole / 60) % 60];
  const rest = `${two(minutes)}:${two(whole % 60)}`;
  return hours > 0 ? `${hours}:${rest}` : `${rest}.${Math.floor((seconds - whole) * 10)}`;
}
