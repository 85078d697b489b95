// Camera, light and canvas: where the model stands and how it is looked at. Draws only when something
// changed.

import { AmbientLight, DirectionalLight, PerspectiveCamera, Scene, Sphere, Spherical, Vector3, WebGLRenderer } from 'three';
import { OrbitControls } from 'three/addons/controls/OrbitControls.js';

import { nextRatio } from '../../state/sharpness.ts';

const kFieldDeg = 32;
const kMostSamples = 4000;
const kAir = 1.06;
const kRestMs = 220; // Without a turn for so long, the view is at rest.
const kFromDirection = new Vector3(0.55, -0.95, 0.75).normalize();

// Throws if the browser has no WebGL.
export class Stage {
  readonly scene = new Scene();
  readonly camera = new PerspectiveCamera(kFieldDeg, 1, 0.1, 1000);
  readonly renderer: WebGLRenderer;
  readonly controls: OrbitControls;
  private readonly resizing: ResizeObserver;
  private frame = 0;
  private readonly sharp = Math.min(devicePixelRatio, 2); // Pixels to one of CSS, at rest.
  private moving = this.sharp; // Likewise, while the view is turned.
  private rest: ReturnType<typeof setTimeout> | undefined;

  constructor(
    private readonly canvas: HTMLCanvasElement,
    private readonly bounds: Sphere,
    private readonly points: ArrayLike<number>, // x y z of what has to be seen whole.
  ) {
    this.renderer = new WebGLRenderer({ canvas, antialias: true, alpha: true, preserveDrawingBuffer: true });
    this.renderer.setPixelRatio(this.sharp);
    this.camera.up.set(0, 0, 1);
    const sun = new DirectionalLight('#ffffff', 2.2);
    sun.position.set(-0.5, 0.8, 0.9);
    this.camera.add(sun);
    this.scene.add(new AmbientLight('#ffffff', 1.45), this.camera);
    this.controls = new OrbitControls(this.camera, canvas);
    // The wheel belongs to the page until the view was clicked or reached by keyboard.
    this.controls.enableZoom = false;
    canvas.addEventListener('focus', () => (this.controls.enableZoom = true));
    canvas.addEventListener('blur', () => (this.controls.enableZoom = false));
    this.controls.addEventListener('change', () => this.drawTurned());
    this.resizing = new ResizeObserver(() => this.resize());
    this.resizing.observe(canvas);
    this.resize();
    this.reset();
  }

  draw(): void {
    this.frame ||= requestAnimationFrame(() => {
      this.frame = 0;
      this.renderer.render(this.scene, this.camera);
    });
  }

  // Turning goes on at once, if need be with fewer pixels; it is drawn sharp when it ends.
  private drawTurned(): void {
    clearTimeout(this.rest);
    this.rest = setTimeout(() => this.drawSharp(), kRestMs);
    if (this.frame !== 0) return;
    this.frame = requestAnimationFrame((begun) => {
      this.frame = 0;
      this.sample(this.moving);
      this.renderer.render(this.scene, this.camera);
      // The next frame begins when this one is on the screen.
      requestAnimationFrame((shown) => (this.moving = nextRatio(this.moving, this.sharp, shown - begun)));
    });
  }

  private drawSharp(): void {
    if (this.renderer.getPixelRatio() === this.sharp) return;
    this.sample(this.sharp);
    this.draw();
  }

  private sample(ratio: number): void {
    if (this.renderer.getPixelRatio() !== ratio) this.renderer.setPixelRatio(ratio);
  }

  private resize(): void {
    const { clientWidth: width, clientHeight: height } = this.canvas;
    if (width === 0 || height === 0) return;
    this.renderer.setSize(width, height, false);
    this.camera.aspect = width / height;
    this.camera.updateProjectionMatrix();
    this.draw();
  }

  reset(): void {
    this.lookFrom(kFromDirection);
  }

  // How far from the middle the camera must be to see everything, with a little air.
  private distanceFor(direction: Vector3): number {
    const { center, radius } = this.bounds;
    const right = new Vector3().crossVectors(this.camera.up, direction).normalize();
    const up = new Vector3().crossVectors(direction, right);
    const high = Math.tan((kFieldDeg * Math.PI) / 360);
    const wide = high * this.camera.aspect;
    let distance = radius * 1.2;
    const step = 3 * Math.max(1, Math.floor(this.points.length / 3 / kMostSamples));
    for (let at = 0; at + 2 < this.points.length; at += step) {
      const away = new Vector3(this.points[at], this.points[at + 1], this.points[at + 2]).sub(center);
      const near = away.dot(direction);
      distance = Math.max(distance, near + Math.abs(away.dot(up)) / high, near + Math.abs(away.dot(right)) / wide);
    }
    return distance * kAir;
  }

  // The whole model, seen from that direction (a unit vector).
  lookFrom(direction: Vector3): void {
    const { center, radius } = this.bounds;
    const distance = this.distanceFor(direction);
    this.camera.near = distance / 100;
    this.camera.far = distance * 20;
    this.camera.position.copy(center).addScaledVector(direction, distance);
    this.camera.updateProjectionMatrix();
    this.controls.target.copy(center);
    this.controls.minDistance = radius * 0.2;
    this.controls.maxDistance = distance * 4;
    this.controls.update();
    this.draw();
  }

  // Moves the camera about the target; the pole points along the camera's up.
  move(change: (around: Spherical) => void): void {
    const { target } = this.controls;
    const offset = this.camera.position.clone().sub(target);
    // Spherical's pole is y: swap the axes there and back.
    const around = new Spherical().setFromCartesianCoords(offset.y, offset.z, offset.x);
    change(around);
    around.makeSafe();
    around.radius = Math.min(this.controls.maxDistance, Math.max(this.controls.minDistance, around.radius));
    const moved = new Vector3().setFromSpherical(around);
    this.camera.position.set(target.x + moved.z, target.y + moved.x, target.z + moved.y);
    this.controls.update();
    this.draw();
  }

  dispose(): void {
    cancelAnimationFrame(this.frame);
    clearTimeout(this.rest);
    this.resizing.disconnect();
    this.controls.dispose();
    this.renderer.dispose();
  }
}
