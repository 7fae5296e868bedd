// Figures as people read them: at most four digits that matter, places, and times.

/** A number with its thousands apart. A comma would read as a decimal sign. @param {number} value */
export const grouped = (value) => value.toLocaleString("en").replaceAll(",", "\u202f");

/** A coordinate, mm: controls and drawings count micrometres, wherever the part lies. @param {number} value */
export const placeText = (value) => (Math.abs(value) < 1e15 ? grouped(Number(value.toFixed(3)) + 0) : String(value));

/** A number with four digits that matter. Whole numbers may count something, so they keep all. @param {number} value */
export function digits(value) {
  if (!Number.isFinite(value)) return String(value);
  const size = Math.abs(value);
  if (size >= 1e15) return value.toExponential(3);
  // Adding 0 makes 0 of -0.
  if (Number.isInteger(value)) return grouped(value + 0);
  if (size >= 1000) return grouped(Number(value.toPrecision(4)));
  if (size < 1e-4) return value.toExponential(2);
  const after = Math.min(6, Math.max(0, 3 - Math.floor(Math.log10(size))));
  return String(Number(value.toFixed(after)));
}

/** A number in little room: large ones as a power of ten. @param {number} value */
export function shortDigits(value) {
  if (Math.abs(value) < 1e5) return digits(value);
  const [factor = "", power = ""] = value.toExponential(3).split("e+");
  const raised = [...power].map((digit) => "⁰¹²³⁴⁵⁶⁷⁸⁹"[Number(digit)]).join("");
  return `${Number(factor)}·10${raised}`;
}

/** A time in words. @param {number} seconds */
export function clock(seconds) {
  const whole = Math.floor(seconds);
  const two = (/** @type {number} */ n) => String(n).padStart(2, "0");
  const [hours, minutes] = [Math.floor(whole / 3600), Math.floor(whole / 60) % 60];
  const rest = `${two(minutes)}:${two(whole % 60)}`;
  return hours > 0 ? `${hours}:${rest}` : `${rest}.${Math.floor((seconds - whole) * 10)}`;
}
