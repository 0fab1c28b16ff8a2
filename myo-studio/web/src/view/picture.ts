// A picture to keep: what is drawn, and what the page writes over it.
import type { Label } from './labels';

/** What the colours say: a heading and a row for each. */
export interface Key {
  heading: string;
  rows: { tone: string; text: string }[];
}

export interface Inks {
  panel: string;
  text: string;
}

/** `width`: of the view on the page (px); the picture may have more pixels. */
export function written(
  drawn: HTMLCanvasElement,
  width: number,
  labels: Label[],
  isSmall: boolean,
  key: Key | undefined,
  inks: Inks,
): Promise<Blob | null> {
  const canvas = document.createElement('canvas');
  [canvas.width, canvas.height] = [drawn.width, drawn.height];
  const pen = canvas.getContext('2d')!;
  pen.drawImage(drawn, 0, 0);
  const scale = drawn.width / width;
  pen.scale(scale, scale);
  pen.textBaseline = 'middle';
  // What is pointed at comes last, on top.
  [...labels]
    .sort((a, b) => Number(a.isRaised) - Number(b.isRaised))
    .forEach((label) => pill(pen, label, isSmall, inks));
  if (key) legend(pen, key, inks);
  return new Promise((resolve) => canvas.toBlob(resolve, 'image/png'));
}

const font = (size: number, weight = 400) => `${weight} ${size}px system-ui, sans-serif`;

function pill(pen: CanvasRenderingContext2D, { parts, x, y, isRaised }: Label, isSmall: boolean, inks: Inks) {
  const isLow = isSmall && !isRaised;
  const pieces = parts.map(({ text, strong }, index) => {
    const words = index > 0 ? ` · ${text}` : text;
    const face = font(isLow ? 9 : 11, strong ? 650 : 400);
    pen.font = face;
    return { words, face, wide: pen.measureText(words).width };
  });
  const wide = pieces.reduce((sum, piece) => sum + piece.wide, isLow ? 6 : 10);
  const high = isLow ? 13 : 17;
  panel(pen, x - wide / 2, y - high / 2, wide, high, high / 2, inks);
  let at = x - wide / 2 + (isLow ? 3 : 5);
  for (const { words, face, wide } of pieces) {
    pen.font = face;
    pen.fillText(words, at, y);
    at += wide;
  }
}

function legend(pen: CanvasRenderingContext2D, { heading, rows }: Key, inks: Inks) {
  pen.font = font(12, 600);
  const head = pen.measureText(heading).width;
  pen.font = font(12);
  const wide = Math.max(head, ...rows.map(({ text }) => 18 + pen.measureText(text).width)) + 20;
  panel(pen, 10, 10, wide, 30 + 19 * rows.length, 8, inks);
  pen.font = font(12, 600);
  pen.fillText(heading, 20, 25);
  pen.font = font(12);
  rows.forEach(({ tone, text }, index) => {
    const y = 45 + 19 * index;
    pen.fillStyle = tone;
    pen.fillRect(20, y - 6, 12, 12);
    pen.fillStyle = inks.text;
    pen.fillText(text, 38, y);
  });
}

/** A ground to write on; the pen then has the ink of letters. */
function panel(
  pen: CanvasRenderingContext2D,
  x: number,
  y: number,
  wide: number,
  high: number,
  round: number,
  { panel, text }: Inks,
) {
  pen.globalAlpha = 0.85;
  pen.fillStyle = panel;
  pen.beginPath();
  pen.roundRect(x, y, wide, high, round);
  pen.fill();
  pen.globalAlpha = 1;
  pen.fillStyle = text;
}
