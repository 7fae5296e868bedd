// The heights that a cutter leaves on a stock, computed from the toolpath of an answer without any code of
// the page's picture.
//
// Curves become straight stretches. Over a point, a stretch lowers the material to the least height of the
// cutter's lower side while the tip goes along the stretch. The height of the lower side is convex in the
// way of the tip, so that a search by sections finds the least.

/** Sections of the search for the deepest place along a stretch: 30 leave 5e-7 of the range. */
const SECTIONS = 30;
/** A section keeps this share of the range: the golden section needs one new height each. */
const GOLDEN = (Math.sqrt(5) - 1) / 2;
/** Shorter ways over the ground count as upright, mm. */
const UPRIGHT_MM = 1e-9;
/** An arc that ends so near to its start, mm, is a whole turn. */
const SAME_MM = 1e-9;
/** Sides of the squares in which stretches are looked up, in radii of the cutter. Smaller squares need more
 * memory, larger squares more time. */
const SQUARE_RADII = 0.5;
/** The two axes of the plane of an arc, so that the turn from the first to the second is counterclockwise. */
const PLANES = { xy: [0, 1], zx: [2, 0], yz: [1, 2] };

/** @typedef {[number, number, number]} Point */
/** `lower` is the height of the lower side over the tip at a distance from the axis.
 * @typedef {{ radius: number, lower: (distance: number) => number, isFlat: boolean }} Cutter */
/** `topAt` is the height of a stock that is no box.
 * @typedef {{ min: number[], max: number[], topAt?: (x: number, y: number) => number }} Stock */

/**
 * The cutter of a request.
 * @param {{ shape: string, diameter_mm: number, corner_radius_mm?: number }} tool
 * @returns {Cutter}
 * @throws {Error} for other shapes than flat, ball and bull nose
 */
export function cutterOf({ shape, diameter_mm, corner_radius_mm = 0 }) {
  const radius = diameter_mm / 2;
  const corner = { flat: 0, ball: radius, bull_nose: corner_radius_mm }[shape];
  if (corner === undefined) throw new Error(`no heights of a cutter of the shape ${shape}`);
  const lower = (distance) => {
    const over = Math.max(distance - (radius - corner), 0);
    return corner - Math.sqrt(Math.max(corner * corner - over * over, 0));
  };
  return { radius, lower, isFlat: corner === 0 };
}

/**
 * The places of the tip in order, where the way between two neighbours is straight.
 * @param {any} toolpath of an answer
 * @param {number} chord how far curves may be from their chords, mm
 * @returns {Point[][]} one list for each way without a jump
 */
export function waysOf(toolpath, chord) {
  let way = [toolpath.start];
  const ways = [way];
  for (const { start, moves } of toolpath.passes) {
    if (start) ways.push(way = [start]);
    for (const move of moves) way.push(...along(way.at(-1), move, chord));
  }
  return ways;
}

/** The places after the start of a move.
 * @param {Point} from @param {any} move @param {number} chord mm @returns {Point[]} */
function along(from, move, chord) {
  switch (move.kind) {
    case "rapid": case "line": return [move.to];
    case "arc": return arc(from, move, chord);
    case "parabola": return parabola(from, move, chord);
    case "dwell": case "turn": return [];
    default: throw new Error(`no way of a move of the kind ${move.kind}`);
  }
}

/** @param {Point} from @param {any} move @param {number} chord mm @returns {Point[]} */
function arc(from, { to, center, plane, direction }, chord) {
  const [a, b] = PLANES[plane];
  const polar = (p) => [Math.atan2(p[b] - center[b], p[a] - center[a]), Math.hypot(p[a] - center[a], p[b] - center[b])];
  const [[begin, radius], [end, last]] = [polar(from), polar(to)];
  const isWhole = Math.hypot(to[a] - from[a], to[b] - from[b]) < SAME_MM;
  const sign = direction === "ccw" ? 1 : -1;
  const turn = 2 * Math.PI;
  const angle = isWhole ? turn : (((sign * (end - begin)) % turn) + turn) % turn;
  const count = Math.max(1, Math.ceil(angle / (2 * Math.acos(Math.max(1 - chord / radius, 0)))));
  return Array.from({ length: count }, (_, k) => {
    const t = (k + 1) / count;
    if (k + 1 === count) return to;
    const point = from.map((x, axis) => x + (to[axis] - x) * t);
    const away = radius + (last - radius) * t;
    point[a] = center[a] + away * Math.cos(begin + sign * angle * t);
    point[b] = center[b] + away * Math.sin(begin + sign * angle * t);
    return point;
  });
}

/** @param {Point} from @param {any} move @param {number} chord mm @returns {Point[]} */
function parabola(from, { to, control }, chord) {
  const bend = Math.hypot(...from.map((x, k) => x - 2 * control[k] + to[k]));
  const count = Math.max(1, Math.ceil(Math.sqrt(bend / (4 * chord))));
  return Array.from({ length: count }, (_, k) => {
    const t = (k + 1) / count;
    return from.map((x, axis) => (1 - t) ** 2 * x + 2 * t * (1 - t) * control[axis] + t * t * to[axis]);
  });
}

/** The heights of a stock after all ways of a cutter. */
export class Heights {
  #cutter;
  #stock;
  /** Both ends of each stretch, six numbers; the stretch that goes lowest is the first.
   * @type {Float64Array} */
  #ends;
  /** The stretches that may touch each square. @type {number[][]} */
  #squares;
  #side;
  #columns;

  /** @param {Point[][]} ways @param {Cutter} cutter @param {Stock} stock */
  constructor(ways, cutter, stock) {
    this.#cutter = cutter;
    this.#stock = stock;
    const stretches = ways.flatMap((way) => way.slice(1).map((end, k) => [...way[k], ...end]))
      .filter((one) => Math.min(one[2], one[5]) < stock.max[2]);
    stretches.sort((one, other) => Math.min(one[2], one[5]) - Math.min(other[2], other[5]));
    this.#ends = Float64Array.from(stretches.flat());
    this.#side = SQUARE_RADII * cutter.radius;
    this.#columns = Math.ceil((stock.max[0] - stock.min[0]) / this.#side);
    const rows = Math.ceil((stock.max[1] - stock.min[1]) / this.#side);
    this.#squares = Array.from({ length: this.#columns * rows }, () => []);
    stretches.forEach((one, k) => this.#putIn(one, k, rows));
  }

  /** Puts a stretch into the squares that it may touch.
   * @param {number[]} ends @param {number} index @param {number} rows */
  #putIn([x0, y0, , x1, y1], index, rows) {
    const side = this.#side;
    const reach = this.#cutter.radius + side * Math.SQRT1_2;
    const { min } = this.#stock;
    const range = (a, b, low, count) => [
      Math.max(0, Math.floor((Math.min(a, b) - reach - low) / side)),
      Math.min(count - 1, Math.floor((Math.max(a, b) + reach - low) / side)),
    ];
    const [left, right] = range(x0, x1, min[0], this.#columns);
    const [front, back] = range(y0, y1, min[1], rows);
    const [dx, dy] = [x1 - x0, y1 - y0];
    const square = dx * dx + dy * dy;
    for (let row = front; row <= back; row++) {
      for (let column = left; column <= right; column++) {
        const [x, y] = [min[0] + (column + 0.5) * side - x0, min[1] + (row + 0.5) * side - y0];
        const t = square > 0 ? Math.min(1, Math.max(0, (x * dx + y * dy) / square)) : 0;
        if ((x - t * dx) ** 2 + (y - t * dy) ** 2 <= reach * reach) this.#squares[row * this.#columns + column].push(index);
      }
    }
  }

  /** The height of the material over a point of the stock. @param {number} x @param {number} y mm */
  at(x, y) {
    const { min, max, topAt } = this.#stock;
    let height = topAt ? topAt(x, y) : max[2];
    const row = Math.floor((y - min[1]) / this.#side);
    const column = Math.floor((x - min[0]) / this.#side);
    for (const k of this.#squares[row * this.#columns + column] ?? []) {
      // The cutter's lower side is nowhere below its tip.
      if (Math.min(this.#ends[6 * k + 2], this.#ends[6 * k + 5]) >= height) break;
      height = Math.min(height, this.#after(6 * k, x, y, height));
    }
    return Math.max(height, min[2]);
  }

  /** The least height of the cutter's lower side over a point along a stretch, or any height that is not
   * below `most` where the least is not either; infinite beside the way of the cutter.
   * @param {number} at where the numbers of the stretch begin
   * @param {number} x @param {number} y @param {number} most mm */
  #after(at, x, y, most) {
    const { radius, lower, isFlat } = this.#cutter;
    const ends = this.#ends;
    const [z0, z1] = [ends[at + 2], ends[at + 5]];
    const [dx, dy, px, py] = [ends[at + 3] - ends[at], ends[at + 4] - ends[at + 1], x - ends[at], y - ends[at + 1]];
    const length = Math.sqrt(dx * dx + dy * dy);
    const isUpright = length < UPRIGHT_MM;
    const ahead = isUpright ? 0 : (px * dx + py * dy) / length;
    const square = Math.max(px * px + py * py - ahead * ahead, 0);
    const nearest = Math.min(Math.max(ahead, 0), length);
    const away = Math.sqrt(square + (ahead - nearest) ** 2);
    if (away > radius) return Infinity;
    const least = Math.min(z0, z1) + lower(away);
    // No tip of the stretch is lower than its lower end, and none is nearer to the point than the nearest.
    if (isUpright || least >= most) return least;
    const slope = (z1 - z0) / length;
    if (slope === 0) return least;
    const half = Math.sqrt(radius * radius - square);
    const [low, high] = [Math.max(ahead - half, 0), Math.min(ahead + half, length)];
    if (isFlat) return Math.min(z0 + slope * low, z0 + slope * high);
    return leastOf((t) => z0 + slope * t + lower(Math.min(Math.sqrt(square + (ahead - t) ** 2), radius)), low, high);
  }
}

/** The least value of a convex function over a range.
 * @param {(t: number) => number} f @param {number} low @param {number} high */
function leastOf(f, low, high) {
  let [a, b] = [high - GOLDEN * (high - low), low + GOLDEN * (high - low)];
  let [fa, fb] = [f(a), f(b)];
  for (let k = 0; k < SECTIONS; k++) {
    if (fa < fb) {
      [high, b, fb] = [b, a, fa];
      a = high - GOLDEN * (high - low);
      fa = f(a);
    } else {
      [low, a, fa] = [a, b, fb];
      b = low + GOLDEN * (high - low);
      fb = f(b);
    }
  }
  return Math.min(fa, fb, f(low), f(high));
}

/**
 * The upper side of triangles over a point; `bottom` beside them.
 * @param {{ positions: ArrayLike<number>, indices: ArrayLike<number> }} body
 * @param {number} bottom mm
 * @returns {(x: number, y: number) => number}
 */
export function topOf({ positions, indices }, bottom) {
  const corner = (k) => [0, 1, 2].map((axis) => positions[3 * indices[k] + axis]);
  const triangles = Array.from({ length: indices.length / 3 }, (_, k) => [corner(3 * k), corner(3 * k + 1), corner(3 * k + 2)]);
  return (x, y) => {
    let top = bottom;
    for (const [a, b, c] of triangles) {
      const whole = (b[0] - a[0]) * (c[1] - a[1]) - (c[0] - a[0]) * (b[1] - a[1]);
      const ofB = ((x - a[0]) * (c[1] - a[1]) - (c[0] - a[0]) * (y - a[1])) / whole;
      const ofC = ((b[0] - a[0]) * (y - a[1]) - (x - a[0]) * (b[1] - a[1])) / whole;
      // An upright triangle has no numbers here, and no place over it.
      if (ofB >= 0 && ofC >= 0 && ofB + ofC <= 1) top = Math.max(top, a[2] + ofB * (b[2] - a[2]) + ofC * (c[2] - a[2]));
    }
    return top;
  };
}
