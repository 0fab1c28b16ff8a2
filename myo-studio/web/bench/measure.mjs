// How quick the page is in this browser: `npm run measure -- ADDRESS`, of a studio that is up. Prints one figure a line.
import { chromium } from '@playwright/test';

const [address = 'http://127.0.0.1:7117/'] = process.argv.slice(2);
const OBJECTS = 30;

const browser = await chromium.launch({
  executablePath: process.env.MYO_BROWSER ?? '/usr/bin/chromium',
  args: ['--no-sandbox', '--use-gl=angle', '--use-angle=swiftshader', '--enable-unsafe-swiftshader'],
});
const page = await (await browser.newContext({ viewport: { width: 1280, height: 720 } })).newPage();
const tell = (what, value, unit) =>
  console.log(`${what}: ${typeof value === 'number' ? value.toFixed(1) : value} ${unit}`);

let bytes = 0;
const session = await page.context().newCDPSession(page);
await session.send('Network.enable');
session.on('Network.loadingFinished', ({ encodedDataLength }) => (bytes += encodedDataLength));

await page.goto(address);
await page.getByRole('list', { name: 'Examples' }).getByRole('button').first().waitFor();
// A busy machine tells of it later.
await page.waitForFunction(() => performance.getEntriesByName('first-contentful-paint').length > 0);
const paint = await page.evaluate(() => performance.getEntriesByName('first-contentful-paint')[0]?.startTime);
tell('first paint', paint, 'ms');

// A task of 30 objects, by import: a grid of buttons written out.
const buttons = Array.from({ length: OBJECTS }, (_, k) => {
  const [row, column] = [Math.floor(k / 6), k % 6];
  return `  b${k}: {kind: button, at: [0.42, ${(0.15 - 0.06 * column).toFixed(3)}, ${(0.05 - 0.06 * row).toFixed(3)}], size: [0.04, 0.04, 0.02], tilt_deg: 90}`;
});
const text = `version: 2\nname: thirty\nscene:\n${buttons.join('\n')}\nscript:\n  - press: [b0, b7, b14]\ntime_limit_s: 5\n`;
await page
  .getByLabel('Task file to import')
  .setInputFiles({ name: 'thirty.yaml', mimeType: 'text/yaml', buffer: Buffer.from(text) });
await page
  .getByRole('list', { name: 'Objects' })
  .getByRole('button')
  .nth(OBJECTS - 1)
  .waitFor();
await page.waitForTimeout(2500);
tell('transfer of the page', bytes / 1024, 'KiB');

// Drags one for four seconds, from within the page: to steer a hand from outside takes half of two processors. Each frame is
// drawn, whether the hand has come far enough to move something or not.
const label = await page.locator('.labels span').first().boundingBox();
const frames = await page.evaluate(
  ([x, y]) =>
    new Promise((resolve) => {
      const [canvas, stage] = [document.querySelector('canvas'), window.myoStage];
      canvas.setPointerCapture = () => {};
      stage.beforeDraw.push(() => stage.draw());
      const hand = (type, clientX, clientY) =>
        canvas.dispatchEvent(new PointerEvent(type, { bubbles: true, clientX, clientY, button: 0, pointerId: 1 }));
      hand('pointerdown', x, y);
      const [begun, before] = [performance.now(), stage.drawn];
      const move = (now) => {
        const elapsed = (now - begun) / 1000;
        hand('pointermove', x + 40 * Math.sin(5 * elapsed), y + 20 * Math.cos(5 * elapsed));
        if (elapsed < 4) requestAnimationFrame(move);
        else {
          hand('pointerup', x, y);
          resolve((stage.drawn - before) / elapsed);
        }
      };
      requestAnimationFrame(move);
    }),
  [label.x + label.width / 2, label.y + label.height / 2],
);
tell(`frames while dragging one of ${OBJECTS}`, frames, '/s');

const socket = `${address.replace('http', 'ws')}engine`;
const times = await page.evaluate(
  async ([url, text]) => {
    const socket = new WebSocket(url);
    await new Promise((resolve) => (socket.onopen = resolve));
    const ask = (id, call, text) =>
      new Promise((resolve) => {
        const begun = performance.now();
        socket.addEventListener('message', function hear({ data }) {
          if (typeof data !== 'string' || JSON.parse(data).id !== id) return;
          socket.removeEventListener('message', hear);
          resolve(performance.now() - begun);
        });
        socket.send(JSON.stringify({ id, call, with: { text } }));
      });
    const median = (list) => list.sort((a, b) => a - b)[Math.floor(list.length / 2)];
    const took = { look: [], check: [] };
    for (let k = 0; k < 40; k++) {
      for (const call of ['look', 'check']) {
        const moved = text.replace('at: [0.42, 0.150', `at: [${(0.4 + k / 1000).toFixed(3)}, 0.150`);
        took[call].push(await ask(2 * k + (call === 'look' ? 0 : 1), call, moved));
      }
    }
    return { look: median(took.look), check: median(took.check) };
  },
  [socket, text],
);
tell('the scene after a change, median', times.look, 'ms');
tell('the check with reach after a change, median', times.check, 'ms');
await browser.close();
