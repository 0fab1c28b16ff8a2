/** Something written beside an object. */
export interface Label {
  /** Number of the object. */
  object: number;
  /** In a row; the strong part is what was asked for. */
  parts: { text: string; strong: boolean }[];
  /** Its middle on the page (px). */
  x: number;
  y: number;
  /** How far the object goes from its middle there (px). */
  extent: number;
  /** What is pointed at, which lies on top of all. */
  isRaised: boolean;
  /** Of two that overlap the weightier one is shown. */
  weight: number;
}

/** From so many on they are small, and those without room are left out until one comes nearer. */
export const MANY = 9;

/** Smaller objects than this have no room for what is said of them (px). */
const ROOM = 8;

/** Of many those that find room: what is pointed at, the weightiest, and whichever of the others have it. */
export function roomy(labels: Label[]): Label[] {
  const kept: Label[] = [];
  const order = [...labels].sort((a, b) => Number(b.isRaised) - Number(a.isRaised) || b.weight - a.weight);
  const first = order.find(({ isRaised }) => !isRaised);
  for (const label of order) {
    const hasRoom = label.isRaised || label === first || label.extent >= ROOM;
    if (hasRoom && !kept.some((other) => overlap(label, other))) kept.push(label);
  }
  return kept.sort((a, b) => a.object - b.object);
}

function overlap(a: Label, b: Label): boolean {
  const [[aWide, aHigh], [bWide, bHigh]] = [size(a), size(b)];
  return Math.abs(a.x - b.x) < (aWide + bWide) / 2 && Math.abs(a.y - b.y) < (aHigh + bHigh) / 2;
}

/** How wide and high a label is at most (px), by the number of its letters. */
function size({ parts, isRaised }: Label): [number, number] {
  const letters = parts.reduce((sum, { text }) => sum + text.length, 3 * (parts.length - 1));
  return isRaised ? [6.2 * letters + 10, 17] : [5 * letters + 6, 13];
}
