// Changes rows of numbers as a table does. A field of kind `numbers` is a table with one column.

/** @typedef {import("./field.js").Field} Field */
/** @typedef {readonly unknown[]} Rows  rows of cells, or cells where the field is of kind `numbers` */

/**
 * @param {Field} field
 * @param {Rows} rows
 * @param {number} row
 * @param {number} column
 * @returns {unknown}
 */
export function cellAt(field, rows, row, column) {
  const found = rows[row];
  if (field.kind === "numbers") return column === 0 ? found : undefined;
  return Array.isArray(found) ? found[column] : undefined;
}

/**
 * The number of columns that are shown: those of the contract, or more where a row is wider.
 * @param {Field} field
 * @param {Rows} rows
 * @returns {number}
 */
export function columnCount(field, rows) {
  if (field.kind === "numbers") return 1;
  const meant = field.most < 64 ? field.most : field.least;
  let widest = meant;
  for (const row of rows) if (Array.isArray(row) && row.length > widest) widest = row.length;
  return widest;
}

/**
 * A copy with one cell replaced.
 * @param {Field} field
 * @param {Rows} rows
 * @param {number} row
 * @param {number} column
 * @param {unknown} value  undefined for an empty cell
 * @returns {Rows}
 */
export function withCell(field, rows, row, column, value) {
  const copy = rows.slice();
  copy[row] = field.kind === "numbers" ? value ?? null : replaced(field, rows[row], column, [value ?? null]);
  return copy;
}

/**
 * A copy with a block of numbers written over the cells from a place on. Rows are added where needed.
 * @param {Field} field
 * @param {Rows} rows
 * @param {number} row
 * @param {number} column
 * @param {number[][]} block
 * @returns {Rows}
 */
export function withBlock(field, rows, row, column, block) {
  const cells = block.map((numbers, at) => replaced(field, rows[row + at], column, numbers));
  return [...rows.slice(0, row), ...valueOf(field, cells), ...rows.slice(row + block.length)];
}

/**
 * @param {Field} field
 * @param {unknown} row
 * @param {number} column
 * @param {unknown[]} cells  to be written from the column on
 * @returns {unknown[]}  the row without empty cells at its end
 */
function replaced(field, row, column, cells) {
  const copy = Array.isArray(row) ? row.slice() : [];
  while (copy.length < column) copy.push(null);
  copy.splice(column, cells.length, ...cells);
  while (copy.length > field.least && copy.at(-1) === null) copy.pop();
  return copy;
}

/**
 * The value of a field for rows of numbers.
 * @param {Field} field
 * @param {readonly unknown[][]} rows
 * @returns {Rows}
 */
export function valueOf(field, rows) {
  return field.kind === "numbers" ? rows.flat() : rows;
}

/**
 * A copy with an empty row before a place.
 * @param {Field} field
 * @param {Rows} rows
 * @param {number} row
 * @returns {Rows}
 */
export function withRow(field, rows, row) {
  const width = Math.max(field.least, 1);
  const empty = field.kind === "numbers" ? null : Array.from({ length: width }, () => null);
  return [...rows.slice(0, row), empty, ...rows.slice(row)];
}

/**
 * A copy without a row.
 * @param {Rows} rows
 * @param {number} row
 * @returns {Rows}
 */
export function withoutRow(rows, row) {
  return [...rows.slice(0, row), ...rows.slice(row + 1)];
}
