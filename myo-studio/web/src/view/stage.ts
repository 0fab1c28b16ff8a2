import {
  Color,
  DirectionalLight,
  GridHelper,
  HemisphereLight,
  PerspectiveCamera,
  Scene,
  Vector2,
  Vector3,
  WebGLRenderer,
} from 'three';
import { type Figure, floorHeight } from './person';
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
    [0.22, 0.05, 1.55],
    [0.25, 0.05, -0.1],
  ],
};

/** How far the camera stands from what it is near to, in its radii, as a share of how far it stands from a person. */
const CLOSE = 1.9;

/** Where the user's eyes are, and what they look at (m). */
export interface Eye {
  position: [number, number, number];
  target: [number, number, number];
}

/** Eyes see more at once than a camera that shows the user. */
const EYE_FOV = 62;

/** A place on the page (px), from its upper left corner. */
export interface Corner {
  left: number;
  top: number;
  width: number;
  height: number;
}

/** How far the second picture stays from the edge (px). */
const EDGE = 10;

/** Where the second picture lies in a view of a size: in the upper right corner, as large as leaves the first one its middle. */
export function corner(width: number, height: number): Corner {
  const wide = Math.round(Math.min(340, Math.max(120, 0.34 * width), 0.6 * height));
  return { left: width - wide - EDGE, top: EDGE, width: wide, height: Math.round(0.75 * wide) };
}

/** Without a graphics card: so long after the last change the picture is at rest, and as fine as it can be (ms). */
const REST_MS = 180;
/** While something moves so many pixels of each in a row are drawn. */
const ROUGH_PIXELS = 0.6;

/** A scene, a camera and light. It draws when something has changed, and every frame while something moves. */
export class Stage {
  readonly scene = new Scene();
  readonly camera = new PerspectiveCamera(38, 1, 0.02, 30);
  readonly renderer: WebGLRenderer;
  readonly controls: OrbitControls;
  /** Called before each drawing, with the time since the last (s). */
  readonly beforeDraw: ((elapsed_s: number) => void)[] = [];
  readonly afterDraw: (() => void)[] = [];
  /** Called when the picture becomes rough, so as to move smoothly, or fine again. */
  readonly onRough: ((on: boolean) => void)[] = [];
  private readonly isSlow = !hasCard();
  private isRough = false;
  private staysFine = false;
  private lastDrawn = -Infinity;
  /** Frames in a row in which nothing was to be drawn: on a slow machine a moving picture takes its time, too. */
  private idle = 2;
  /** Called before each of the two pictures. */
  readonly beforePicture: ((camera: PerspectiveCamera, isSecond: boolean) => void)[] = [];
  /** What the camera of the second picture is; none without one. */
  second: View | undefined;
  /** How the user sees. */
  eye: Eye | undefined;
  private readonly other = new PerspectiveCamera(40, 4 / 3, 0.02, 30);
  private readonly size = new Vector2();
  private frameTone = new Color();
  private readonly sky = new HemisphereLight();
  private readonly sun = new DirectionalLight();
  private grid: GridHelper;
  private dark: boolean;
  private sitting = false;
  private stature = 1;
  private isLeft = false;
  private near: Figure['near'];
  private floorAt: number | undefined;
  /** how it looked last */
  private view: View = 'behind';
  private isEye = false;
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
    this.renderer = new WebGLRenderer({ canvas, antialias: !this.isSlow, powerPreference: 'high-performance' });
    this.camera.up.set(0, 0, 1);
    this.other.up.set(0, 0, 1);
    this.controls = new OrbitControls(this.camera, canvas);
    this.controls.addEventListener('change', () => this.draw());
    this.controls.enableDamping = false;
    this.controls.minDistance = 0.1;
    this.controls.maxDistance = 6;
    this.sky.position.set(0, 0, 1);
    this.scene.add(this.sky, this.sun, this.sun.target);
    this.dark = dark;
    this.grid = this.floor();
    this.setTheme(dark);
    this.look('behind');
    this.request = requestAnimationFrame(this.frame);
  }

  setTheme(dark: boolean) {
    this.dark = dark;
    this.scene.background = new Color(dark ? 0x14171c : 0xf3f4f6);
    this.frameTone.set(dark ? 0x4a525e : 0xb4bac4);
    this.sky.color.set(dark ? 0xd3deee : 0xffffff);
    this.sky.groundColor.set(dark ? 0x4a505c : 0xb9bcc6);
    this.sky.intensity = dark ? 1.7 : 2;
    this.sun.color.set(dark ? 0xffffff : 0xfff6ea);
    this.sun.intensity = dark ? 2 : 1.5;
    this.layFloor();
  }

  /** Whoever sits is nearer to the floor: the shoulder stays where it is. */
  setSitting(sitting: boolean) {
    if (sitting === this.sitting) return;
    this.sitting = sitting;
    this.layFloor();
  }

  /**
   * The floor under somebody so many times as tall as the figure is made, and views at the arm that moves, or from nearby at the
   * hand that alone does.
   */
  setPerson({ size, isLeft, near, floor }: Pick<Figure, 'size' | 'isLeft' | 'near' | 'floor'>) {
    const isOtherView = isLeft !== this.isLeft || near !== this.near;
    if (size === this.stature && !isOtherView) return;
    this.stature = size;
    this.isLeft = isLeft;
    this.near = near;
    this.floorAt = floor;
    this.layFloor();
    if (isOtherView) this.look(this.view);
  }

  private layFloor() {
    this.scene.remove(this.grid);
    this.grid.dispose();
    this.grid = this.floor();
    this.draw();
  }

  private floor(): GridHelper {
    const [major, minor] = this.dark ? [0x343a44, 0x262b33] : [0xc9ced6, 0xdfe3e8];
    const grid = new GridHelper(4, 16, major, minor);
    grid.rotation.x = Math.PI / 2;
    grid.position.set(0.5, this.isLeft ? -0.17 : 0.17, this.floorAt ?? this.stature * floorHeight(this.sitting));
    // Before all that leaves no depth.
    grid.renderOrder = -2;
    this.scene.add(grid);
    return grid;
  }

  look(view: View) {
    const seen = this.of(view);
    if (!seen) return;
    this.view = view;
    this.isEye = view === 'eyes';
    this.lens();
    this.camera.position.set(...seen[0]);
    this.controls.target.set(...seen[1]);
    this.controls.update();
    this.draw();
  }

  /** From where to where a view looks. */
  private of(view: View): (typeof VIEWS)['behind'] | undefined {
    if (view !== 'eyes') {
      const [from, to] = VIEWS[view];
      const side = ([x, y, z]: [number, number, number]): [number, number, number] => [x, this.isLeft ? -y : y, z];
      if (!this.near) return [side(from), side(to)];
      const { at, radius } = this.near;
      const away = side([from[0] - to[0], from[1] - to[1], from[2] - to[2]]);
      const [x, y, z] = away.map((far, axis) => at[axis] + CLOSE * radius * far);
      return [[x, y, z], at];
    }
    return this.eye && [this.eye.position, this.eye.target];
  }

  /** A narrow picture shows as much from left to right. */
  private lens() {
    this.camera.fov = this.isEye ? EYE_FOV : this.camera.aspect < 1 ? 52 : 38;
    this.camera.updateProjectionMatrix();
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
    this.setPixels();
    this.renderer.setSize(width, height, false);
    this.camera.aspect = width / height;
    this.lens();
    this.draw();
  }

  private setPixels() {
    // More than two pixels of the screen for one of the page are not seen, but take time.
    this.renderer.setPixelRatio(Math.min(devicePixelRatio, 2) * (this.isRough ? ROUGH_PIXELS : 1));
  }

  /** Keeps the picture fine whatever moves, as for a film. */
  stayFine(on: boolean) {
    this.staysFine = on;
    if (on) this.setRough(false);
  }

  private setRough(on: boolean) {
    if (on === this.isRough) return;
    this.isRough = on;
    this.setPixels();
    this.onRough.forEach((call) => call(on));
    this.draw();
  }

  private frame = (now: number) => {
    this.request = requestAnimationFrame(this.frame);
    const elapsed = Math.min(0.1, (now - this.last) / 1000);
    this.last = now;
    this.beforeDraw.forEach((call) => call(elapsed));
    const isResting = this.idle > 1 && now - this.lastDrawn > REST_MS;
    if (this.wants || isResting) this.setRough(this.isSlow && !this.staysFine && !isResting);
    this.idle = this.wants ? 0 : this.idle + 1;
    if (!this.wants) return;
    this.wants = false;
    this.lastDrawn = now;
    this.drawn += 1;
    this.render();
    this.afterDraw.forEach((call) => call());
  };

  /** Draws the picture, and the second one into its corner. */
  private render() {
    this.beforePicture.forEach((call) => call(this.camera, false));
    this.shine(this.camera, this.controls.target);
    this.renderer.render(this.scene, this.camera);
    if (this.second) this.renderSecond(this.second);
  }

  private renderSecond(view: View) {
    const seen = this.of(view);
    if (!seen) return;
    const target = new Vector3(...seen[1]);
    this.other.position.set(...seen[0]);
    this.other.fov = view === 'eyes' ? EYE_FOV : 40;
    this.other.updateProjectionMatrix();
    this.other.lookAt(target);
    this.other.updateMatrixWorld();
    const { renderer, size } = this;
    renderer.getSize(size);
    const { left, top, width, height } = corner(size.x, size.y);
    const bottom = size.y - top - height;
    renderer.setScissorTest(true);
    // Its frame is drawn with it: films and pictures have it, too.
    renderer.setScissor(left - 1, bottom - 1, width + 2, height + 2);
    renderer.setClearColor(this.frameTone);
    renderer.clear();
    renderer.setScissor(left, bottom, width, height);
    renderer.setViewport(left, bottom, width, height);
    this.beforePicture.forEach((call) => call(this.other, true));
    this.shine(this.other, target);
    renderer.render(this.scene, this.other);
    renderer.setScissorTest(false);
    renderer.setViewport(0, 0, size.x, size.y);
  }

  /** Light comes from the upper left of whoever looks: from behind a fixed one would leave everything flat. */
  private shine(camera: PerspectiveCamera, target: Vector3) {
    const { position } = this.sun;
    position.set(-1, 1.4, 1.2).applyQuaternion(camera.quaternion).add(target);
    this.sun.target.position.copy(target);
  }

  /** Draws it as it is now, as fine as it can be: what is on the canvas then holds until the browser shows it. */
  drawFine(): HTMLCanvasElement {
    this.setRough(false);
    this.render();
    return this.canvas;
  }

  /** The picture as it is now. */
  png(): Promise<Blob | null> {
    this.drawFine();
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
