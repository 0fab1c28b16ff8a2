import type { Engine } from '../engine/engine';
import type { PresetCard } from '../engine/protocol';
import { Film } from './motion';
import { Objects } from './objects';
import { type Figure, figureOf } from './person';
import { Stage } from './stage';

const [WIDTH, HEIGHT] = [440, 300];

/** Where pictures are kept from one visit to the next. A new version draws them anew. */
const key = (version: string, dark: boolean, name: string) => `myo-card ${version} ${dark ? 'dark' : 'light'} ${name}`;

export function kept(version: string, dark: boolean, name: string): string | undefined {
  return localStorage.getItem(key(version, dark, name)) ?? undefined;
}

/** Draws the user before each task, one after the other, and tells each picture when it is there. Ends early if `goesOn` says so. */
export async function draw(
  engine: Engine,
  version: string,
  presets: PresetCard[],
  dark: boolean,
  goesOn: () => boolean,
  tell: (name: string, picture: string) => void,
) {
  const canvas = document.createElement('canvas');
  const stage = new Stage(canvas, dark);
  stage.resize(WIDTH, HEIGHT);
  const people = new Map<string, Figure>();
  try {
    for (const preset of presets) {
      const [look, pose] = [await engine.ask('look', { text: preset.text }), await engine.pose({ text: preset.text })];
      if (!goesOn()) return;
      if (!look.view) continue;
      const { model, body, objects: views } = look.view;
      const whose = JSON.stringify([model, body]);
      const person = people.get(whose) ?? figureOf(await engine.ask('body', { model, body }), { dark });
      people.set(whose, person);
      person.pose(Film.of(pose).frame(0));
      stage.setPerson(person);
      const objects = new Objects(dark);
      objects.show(views, () => ({ selected: false, wrong: false }));
      stage.scene.add(person.group, objects.group);
      const png = await stage.png();
      stage.scene.remove(person.group, objects.group);
      if (!png || !goesOn()) return;
      const picture = await asAddress(png);
      keep(key(version, dark, preset.name), picture);
      tell(preset.name, picture);
      // Whoever clicks meanwhile comes first.
      await new Promise((resolve) => setTimeout(resolve, 30));
    }
  } finally {
    people.forEach((person) => person.dispose());
    stage.dispose();
  }
}

function asAddress(blob: Blob): Promise<string> {
  return new Promise((resolve) => {
    const reader = new FileReader();
    reader.onload = () => resolve(String(reader.result));
    reader.readAsDataURL(blob);
  });
}

/** Where there is no room they are drawn anew the next time. */
function keep(key: string, picture: string) {
  try {
    localStorage.setItem(key, picture);
  } catch {
    // Full, or not allowed.
  }
}
