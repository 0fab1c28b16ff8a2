import {
  Color,
  DirectionalLight,
  GridHelper,
  HemisphereLight,
  PerspectiveCamera,
  Scene,
  Vector3,
  WebGLRenderer,
} from 'three';
import { floorHeight } from './person';
import { OrbitControls } from 'three/examples/jsm/controls/OrbitControls.js';

export type View = 'behind' | 'side' | 'front' | 'above' | 'eyes';

/** Where the camera stands and looks, from the shoulder centre (m). */
const VIEWS: Record<Exclude<View, 'eyes'>, [[number, number, number], [number, number, number]]> = {
  behind: [
    [-0.95, -1.0, 0.6],
    [0.24, 0.06, -0.14],
  ],
  side: [
    [0.25, -1.6, 0.1],
    [0.25, 0.05, -0.12],
  ],
  front: [
    [1.9, 0.1, 0.15],
    [0.1, 0.1, -0.12],
  ],
  above: [
    [0.22, 0.06, 1.55],
    [0.25, 0.05, -0.1],
  ],
};

/** A scene, a camera and light. It draws when something has changed, and every frame while something moves. */
export class Stage {
  readonly scene = new Scene();
  readonly camera = new PerspectiveCamera(38, 1, 0.02, 30);
  readonly renderer: WebGLRenderer;
  readonly controls: OrbitControls;
  /** Called before each drawing, with the time since the last (s). */
  readonly beforeDraw: ((elapsed_s: number) => void)[] = [];
  readonly afterDraw: (() => void)[] = [];
  private readonly sky = new HemisphereLight();
  private readonly sun = new DirectionalLight();
  private grid: GridHelper;
  private wants = true;
  private last = 0;
  private request = 0;
  /** Frames that were drawn, for those who measure. */
  drawn = 0;

  constructor(
    private readonly canvas: HTMLCanvasElement,
    dark: boolean,
  ) {
    // Smooth edges take a processor that draws by itself half of its time.
    this.renderer = new WebGLRenderer({ canvas, antialias: hasCard(), powerPreference: 'high-performance' });
    this.camera.up.set(0, 0, 1);
    this.controls = new OrbitControls(this.camera, canvas);
    this.controls.addEventListener('change', () => this.draw());
    this.controls.enableDamping = false;
    this.controls.minDistance = 0.25;
    this.controls.maxDistance = 6;
    this.sky.position.set(0, 0, 1);
    this.scene.add(this.sky, this.sun, this.sun.target);
    this.grid = this.floor(dark);
    this.setTheme(dark);
    this.look('behind');
    this.request = requestAnimationFrame(this.frame);
  }

  setTheme(dark: boolean) {
    this.scene.background = new Color(dark ? 0x14171c : 0xf3f4f6);
    this.sky.color.set(dark ? 0xd3deee : 0xffffff);
    this.sky.groundColor.set(dark ? 0x4a505c : 0xb9bcc6);
    this.sky.intensity = dark ? 1.7 : 2;
    this.sun.color.set(dark ? 0xffffff : 0xfff6ea);
    this.sun.intensity = dark ? 2 : 1.5;
    this.scene.remove(this.grid);
    this.grid = this.floor(dark);
    this.draw();
  }

  private floor(dark: boolean): GridHelper {
    const [major, minor] = dark ? [0x343a44, 0x262b33] : [0xc9ced6, 0xdfe3e8];
    const grid = new GridHelper(4, 16, major, minor);
    grid.rotation.x = Math.PI / 2;
    grid.position.set(0.5, 0.17, floorHeight(false));
    this.scene.add(grid);
    return grid;
  }

  look(view: Exclude<View, 'eyes'>) {
    const [from, to] = VIEWS[view];
    this.camera.position.set(...from);
    this.controls.target.set(...to);
    this.controls.update();
    this.draw();
  }

  lookFrom(position: [number, number, number], forward: [number, number, number]) {
    this.camera.position.set(...position);
    this.controls.target.copy(new Vector3(...position).addScaledVector(new Vector3(...forward), 0.45));
    this.controls.update();
    this.draw();
  }

  /** Comes so near, from where the camera stands, that these fill a good part of the picture. */
  focus(objects: { at: [number, number, number]; size: number }[]) {
    const places = objects.map(({ at }) => new Vector3(...at));
    const middle = places.reduce((sum, place) => sum.add(place), new Vector3()).divideScalar(places.length);
    const radius = Math.max(...objects.map(({ size }, index) => places[index].distanceTo(middle) + size), 0.05);
    const away = this.camera.position.clone().sub(this.controls.target).normalize();
    this.controls.target.copy(middle);
    this.camera.position.copy(middle).addScaledVector(away, Math.max(this.controls.minDistance, 4.5 * radius));
    this.controls.update();
    this.draw();
  }

  /** The scene has changed. */
  draw() {
    this.wants = true;
  }

  resize(width: number, height: number) {
    if (width === 0 || height === 0) return;
    // More than two pixels of the screen for one of the page are not seen, but take time.
    this.renderer.setPixelRatio(Math.min(devicePixelRatio, 2));
    this.renderer.setSize(width, height, false);
    this.camera.aspect = width / height;
    // A narrow picture shows as much from left to right.
    this.camera.fov = width < height ? 52 : 38;
    this.camera.updateProjectionMatrix();
    this.draw();
  }

  private frame = (now: number) => {
    this.request = requestAnimationFrame(this.frame);
    const elapsed = Math.min(0.1, (now - this.last) / 1000);
    this.last = now;
    this.beforeDraw.forEach((call) => call(elapsed));
    if (!this.wants) return;
    this.wants = false;
    this.drawn += 1;
    this.shine();
    this.renderer.render(this.scene, this.camera);
    this.afterDraw.forEach((call) => call());
  };

  /** Light comes from the upper left of whoever looks: from behind a fixed one would leave everything flat. */
  private shine() {
    const { position } = this.sun;
    position.set(-1, 1.4, 1.2).applyQuaternion(this.camera.quaternion).add(this.controls.target);
    this.sun.target.position.copy(this.controls.target);
  }

  /** The picture as it is now. */
  png(): Promise<Blob | null> {
    this.shine();
    this.renderer.render(this.scene, this.camera);
    return new Promise((resolve) => this.canvas.toBlob(resolve, 'image/png'));
  }

  dispose() {
    cancelAnimationFrame(this.request);
    this.controls.dispose();
    this.renderer.dispose();
  }
}

/** Whether a graphics card draws, and not the processor. */
function hasCard(): boolean {
  const context = document.createElement('canvas').getContext('webgl2');
  const info = context?.getExtension('WEBGL_debug_renderer_info');
  const name = info ? String(context?.getParameter(info.UNMASKED_RENDERER_WEBGL)) : '';
  context?.getExtension('WEBGL_lose_context')?.loseContext();
  return !/swiftshader|llvmpipe|software|basic render/i.test(name);
}
