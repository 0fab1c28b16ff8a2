/** Lines over a common axis. */
export interface Graph {
  title: string;
  /** What the axes are of, with their units. */
  xName: string;
  yName: string;
  x: number[];
  lines: { name: string; y: (number | null)[] }[];
}

const [WIDTH, HEIGHT] = [520, 300];
const EDGE = { left: 58, right: 16, top: 34, bottom: 46 };
const LEGEND_HEIGHT = 18;
/** As wide as a letter on the average (px). */
const LETTER = 6.2;
/** Dark enough for white paper, and each with dashes of its own, for paper without colours. */
const STROKES = [
  ['#1f4e80', ''],
  ['#a03c16', '7 3'],
  ['#226a47', '2 3'],
  ['#6a3f94', '9 3 2 3'],
  ['#6b5f14', '4 2'],
] as const;

/** Writes lines as a picture that can be printed: black on white, with axes that have round numbers. */
export function curveSvg(graph: Graph): string {
  const isNumber = (value: number | null): value is number => value !== null && Number.isFinite(value);
  const across = ticks(bounds(graph.x.filter(isNumber)), 6);
  const up = ticks(bounds(graph.lines.flatMap(({ y }) => y.filter(isNumber))), 5);
  const [names, nameRows] = legend(graph);
  const top = EDGE.top + LEGEND_HEIGHT * nameRows;
  const height = HEIGHT + LEGEND_HEIGHT * nameRows;
  // Along x the lines fill the picture; upwards it begins and ends at a round number.
  const [left, right] = bounds(graph.x.filter(isNumber));
  const x = scale([left, right], [EDGE.left, WIDTH - EDGE.right]);
  const y = scale([up[0], up.at(-1)!], [height - EDGE.bottom, top]);
  const shown = across.filter((tick) => tick >= left - 1e-9 && tick <= right + 1e-9);
  const parts = [
    `<text x="${EDGE.left}" y="20" font-size="14" font-weight="600">${escape(graph.title)}</text>`,
    names,
    ...up.map((tick) => line(EDGE.left, y(tick), WIDTH - EDGE.right, y(tick), '#d9d9d9')),
    ...up.map((tick) => text(EDGE.left - 8, y(tick) + 4, word(tick, up), 'end', 'y-tick')),
    ...shown.map((tick) => line(x(tick), y(up[0]), x(tick), y(up[0]) + 5, '#000')),
    ...shown.map((tick) => text(x(tick), y(up[0]) + 19, word(tick, across), 'middle', 'x-tick')),
    line(EDGE.left, y(up[0]), WIDTH - EDGE.right, y(up[0]), '#000'),
    line(EDGE.left, y(up[0]), EDGE.left, top, '#000'),
    text((EDGE.left + WIDTH - EDGE.right) / 2, height - 8, graph.xName, 'middle'),
    `<text transform="translate(15 ${(top + height - EDGE.bottom) / 2}) rotate(-90)" text-anchor="middle">${escape(graph.yName)}</text>`,
    ...graph.lines.map((one, index) => path(graph.x, one.y, x, y, index)),
  ];
  return `<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 ${WIDTH} ${height}" width="${WIDTH}" height="${height}" font-family="Helvetica, Arial, sans-serif" font-size="12" fill="#000">
<title>${escape(graph.title)}</title>
<rect width="${WIDTH}" height="${height}" fill="#fff"/>
${parts.filter(Boolean).join('\n')}
</svg>
`;
}

/** Round numbers that hold a range, about so many. */
export function ticks([low, high]: [number, number], about: number): number[] {
  const rough = (high - low) / about;
  const power = 10 ** Math.floor(Math.log10(rough));
  const step = power * ([1, 2, 5].find((factor) => factor * power >= rough * (1 - 1e-9)) ?? 10);
  const [first, last] = [Math.floor(low / step + 1e-9), Math.ceil(high / step - 1e-9)];
  return Array.from({ length: last - first + 1 }, (_, index) => Number(((first + index) * step).toPrecision(12)));
}

function bounds(values: number[]): [number, number] {
  if (values.length === 0) return [0, 1];
  const [low, high] = values.reduce(([low, high], v) => [Math.min(low, v), Math.max(high, v)], [Infinity, -Infinity]);
  const room = Math.abs(low) * 0.1 || 0.5;
  return low === high ? [low - room, high + room] : [low, high];
}

const scale =
  ([a, b]: [number, number], [from, to]: [number, number]) =>
  (value: number) =>
    Math.round((from + ((value - a) / (b - a)) * (to - from)) * 100) / 100;

/** A number with as many digits as tell the ticks apart. */
function word(tick: number, all: number[]): string {
  const step = all.length > 1 ? all[1] - all[0] : 1;
  return tick.toFixed(Math.max(0, -Math.floor(Math.log10(step) + 1e-9))).replace('-', '−');
}

/** The names of several lines, row by row, and how many rows that takes. */
function legend({ lines }: Graph): [string, number] {
  if (lines.length < 2) return ['', 0];
  let [x, row] = [EDGE.left, 0];
  const parts = lines.map(({ name }, index) => {
    const wide = 34 + LETTER * name.length + 14;
    if (x > EDGE.left && x + wide > WIDTH - EDGE.right) [x, row] = [EDGE.left, row + 1];
    const [at, y] = [x, EDGE.top + 6 + LEGEND_HEIGHT * row];
    x += wide;
    const [tone, dashes] = STROKES[index % STROKES.length];
    return line(at, y - 4, at + 26, y - 4, tone, dashes, 1.8) + text(at + 32, y, name, 'start', 'name');
  });
  return [parts.join('\n'), row + 1];
}

/** A line, with gaps where there are no values. */
function path(
  at: number[],
  values: (number | null)[],
  x: (v: number) => number,
  y: (v: number) => number,
  index: number,
): string {
  let isDown = false;
  const way = values.flatMap((value, k) => {
    if (value === null || !Number.isFinite(value)) {
      isDown = false;
      return [];
    }
    const point = `${isDown ? 'L' : 'M'}${x(at[k])} ${y(value)}`;
    isDown = true;
    return [point];
  });
  const [tone, dashes] = STROKES[index % STROKES.length];
  const dash = dashes ? ` stroke-dasharray="${dashes}"` : '';
  return `<path d="${way.join(' ')}" fill="none" stroke="${tone}" stroke-width="1.6" stroke-linejoin="round"${dash}/>`;
}

function line(x1: number, y1: number, x2: number, y2: number, tone: string, dashes = '', wide = 1): string {
  const dash = dashes ? ` stroke-dasharray="${dashes}"` : '';
  return `<line x1="${x1}" y1="${y1}" x2="${x2}" y2="${y2}" stroke="${tone}" stroke-width="${wide}"${dash}/>`;
}

function text(x: number, y: number, words: string, anchor: string, kind = ''): string {
  return `<text x="${x}" y="${y}" text-anchor="${anchor}"${kind && ` class="${kind}"`}>${escape(words)}</text>`;
}

function escape(words: string): string {
  return words.replaceAll('&', '&amp;').replaceAll('<', '&lt;').replaceAll('>', '&gt;').replaceAll('"', '&quot;');
}
