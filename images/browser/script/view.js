// The stage in three dimensions: its content, the camera, and the object under the pointer.

import {
  Box3, Color, DirectionalLight, Group, HemisphereLight, MOUSE, Mesh, MeshBasicMaterial, PerspectiveCamera, Quaternion,
  Raycaster, Scene, SphereGeometry, Spherical, Vector2, Vector3, WebGLRenderer,
} from 'three';
import { OrbitControls } from 'three/addons/controls/OrbitControls.js';
import { Arrow } from './arrows.js';
import { palette } from './colours.js';
import { Painting, makeBody } from './bodies.js';
import { Rays, makeLamps } from './light.js';

// In three.js y is up; this rotation of spherical coordinates makes z up.
const upright = new Quaternion().setFromUnitVectors(new Vector3(0, 0, 1), new Vector3(0, 1, 0));

// Colours of the bodies in order; the first body is solid. In a diagnosis: nominal, improved.
export const bodyColours = [palette.grey, palette.vermilion, palette.blue];

const widest = 4 / 3;  // ratio of width to height up to which the field of view is across the width

export class StageView {
  // Throws an error if the browser has no WebGL.
  constructor(canvas, stage, maps, colours) {
    this.canvas = canvas;
    this.stage = stage;
    this.renderer = new WebGLRenderer({ canvas, antialias: true, preserveDrawingBuffer: true });
    this.renderer.setPixelRatio(Math.min(window.devicePixelRatio, 2));
    this.scene = new Scene();
    this.scene.background = new Color('#f4f6f8');
    this.scene.add(new HemisphereLight('#ffffff', '#b9c2cc', 2.1));
    this.makeCamera();
    this.bodies = stage.bodies.map((_, i) => makeBody(stage.parts, i === 0 ? null : bodyColours[i] ?? palette.blue));
    this.scene.add(...this.bodies);
    this.paintings = stage.paintings.map((json) => new Painting(json, maps, colours));
    for (const painting of this.paintings) this.bodies[0].add(painting.group);
    this.lamps = makeLamps(stage.lamps, stage.radius);
    this.rays = new Rays();
    this.arrows = stage.arrows.map((json, i) => {
      const order = stage.arrows.slice(0, i).filter((other) => other.kind === json.kind).length;
      return new Arrow(json, this.lengthOf(json, i), order);
    });
    for (const arrow of this.arrows) this.bodies[0].add(arrow.group);
    this.marker = new Mesh(new SphereGeometry(0.014 * stage.radius, 16, 12),
      new MeshBasicMaterial({ color: '#d55e00', depthTest: false, transparent: true }));
    this.marker.renderOrder = 11;
    this.marker.visible = false;
    this.bodies[0].add(this.marker);
    this.lit = new Group();
    this.lit.add(this.lamps, this.rays.lines);
    this.scene.add(this.lit);
    this.paint(0);
    new ResizeObserver(() => this.resize()).observe(canvas.parentElement);
    this.resize();
  }

  makeCamera() {
    const { camera, radius } = this.stage;
    this.camera = new PerspectiveCamera(34, 1, radius / 100, radius * 400);
    this.camera.up.set(0, 0, 1);
    this.headlight = new DirectionalLight('#ffffff', 1.1);
    this.camera.add(this.headlight);
    this.scene.add(this.camera);
    this.controls = new OrbitControls(this.camera, this.canvas);
    this.controls.mouseButtons = { LEFT: MOUSE.ROTATE, MIDDLE: MOUSE.DOLLY, RIGHT: MOUSE.PAN };
    // The wheel scrolls the page; it zooms the scene only while the scene has the focus.
    this.controls.enableZoom = false;
    this.canvas.addEventListener('focus', () => { this.controls.enableZoom = true; });
    this.canvas.addEventListener('blur', () => { this.controls.enableZoom = false; });
    this.controls.addEventListener('change', () => this.draw());
    this.canvas.addEventListener('keydown', (event) => this.key(event));
    this.field = camera.field_of_view_deg;
    this.near = { position: new Vector3(...camera.position), target: new Vector3(...camera.target) };
    this.far = this.near;
  }

  // Viewpoint for body and lamps together, in the direction of the experiment's camera.
  framing(aspect) {
    const { lamps, radius } = this.stage;
    const near = lamps.filter((lamp) => !lamp.far).map((lamp) => new Vector3(...lamp.position))
      .filter((at) => at.length() < 10 * radius);
    if (near.every((at) => at.length() < 1.5 * radius)) return this.near;
    const back = this.near.position.clone().sub(this.near.target).normalize();
    // Lower than for the body alone, because lamps above the body would hide it.
    back.z = Math.min(back.z, 0.35);
    back.normalize();
    const right = new Vector3(0, 0, 1).cross(back).normalize(), up = back.clone().cross(right);
    const around = [right, up].flatMap((axis) => [-radius, radius].map((r) => axis.clone().multiplyScalar(r)));
    const points = [...near, ...around];
    const target = new Box3().setFromPoints(points).getCenter(new Vector3());
    const half = Math.tan(this.field / 2 * Math.PI / 180);
    const distance = Math.max(...points.map((point) => {
      const from = point.clone().sub(target);
      return from.dot(back) + 1.08 * Math.max(Math.abs(from.dot(right)) / half, Math.abs(from.dot(up)) / half * aspect);
    }));
    return { position: target.clone().addScaledVector(back, distance), target };
  }

  // Drawn length of a vector: the longest of all states is as long as the body, unless the vector
  // states a scale.
  lengthOf(json, which) {
    if (json.m_per_unit > 0) return (value) => value * json.m_per_unit;
    const { arrow } = this.stage.states;
    const stride = 3 * this.stage.arrows.length;
    let longest = 0;
    for (let i = 3 * which; i < arrow.length; i += stride) {
      longest = Math.max(longest, Math.hypot(arrow[i], arrow[i + 1], arrow[i + 2]));
    }
    const reach = (json.kind === 'force' ? 0.75 : 0.95) * this.stage.radius;
    return (value) => (longest > 0 ? reach * value / longest : 0);
  }

  resize() {
    const { clientWidth, clientHeight } = this.canvas.parentElement;
    if (clientWidth === 0 || clientHeight === 0) return;
    this.renderer.setSize(clientWidth, clientHeight, false);
    this.camera.aspect = clientWidth / clientHeight;
    // The field of view is across the width. Pictures wider than `widest` show more on both sides.
    const half = Math.tan(this.field / 2 * Math.PI / 180) / Math.min(this.camera.aspect, widest);
    this.camera.fov = 2 * Math.atan(half) * 180 / Math.PI;
    this.camera.updateProjectionMatrix();
    this.far = this.framing(Math.min(this.camera.aspect, widest));
    if (!this.placed) this.reset();
    this.draw();
  }

  reset() {
    this.placed = true;
    this.lookAs(this.far);
  }

  closeUp() {
    this.lookAs(this.near);
  }

  lookAs({ position, target }) {
    this.camera.position.copy(position);
    this.controls.target.copy(target);
    this.controls.update();
    this.draw();
  }

  // Looks along a direction, from the present distance.
  lookFrom(direction) {
    const distance = this.camera.position.distanceTo(this.controls.target);
    this.camera.position.copy(this.controls.target).addScaledVector(new Vector3(...direction).normalize(), distance);
    this.controls.update();
    this.draw();
  }

  turn(around, polar, closer) {
    const offset = this.camera.position.clone().sub(this.controls.target).applyQuaternion(upright);
    const at = new Spherical().setFromVector3(offset);
    at.theta += around;
    at.phi = Math.min(Math.max(at.phi + polar, 0.01), Math.PI - 0.01);
    at.radius *= closer;
    offset.setFromSpherical(at).applyQuaternion(upright.clone().invert());
    this.camera.position.copy(this.controls.target).add(offset);
    this.controls.update();
    this.draw();
  }

  key(event) {
    const step = 5 * Math.PI / 180;
    const keys = {
      ArrowLeft: () => this.turn(-step, 0, 1), ArrowRight: () => this.turn(step, 0, 1),
      ArrowUp: () => this.turn(0, -step, 1), ArrowDown: () => this.turn(0, step, 1),
      '+': () => this.turn(0, 0, 0.9), '=': () => this.turn(0, 0, 0.9), '-': () => this.turn(0, 0, 1 / 0.9),
      Home: () => this.reset(),
    };
    if (!keys[event.key]) return;
    event.preventDefault();
    keys[event.key]();
  }

  paint(index) {
    this.paintings.forEach((painting, i) => { painting.group.visible = i === index; });
    this.painting = this.paintings[index] ?? null;
    this.draw();
  }

  // Shows the state between `from` and `to`; `fraction` 0 is `from`.
  show(from, to, fraction) {
    const { states } = this.stage;
    const nearest = fraction < 0.5 ? from : to;
    this.bodies.forEach((body, b) => {
      const attitude = (state) => {
        const [w, x, y, z] = states.attitude.subarray(4 * (state * this.bodies.length + b));
        return new Quaternion(x, y, z, w);
      };
      body.quaternion.copy(attitude(from)).slerp(attitude(to), fraction);
    });
    this.arrows.forEach((arrow, a) => {
      const at = (of, state) => of.subarray(3 * (state * this.arrows.length + a)).slice(0, 3);
      const start = at(states.arrow, from), end = at(states.arrow, to);
      arrow.set([...start].map((v, k) => v + fraction * (end[k] - v)), [...at(states.arrow_error, nearest)]);
    });
    const light = this.stage.light_of_state[nearest] ?? nearest;
    for (const painting of this.paintings) painting.show(light);
    const { rays } = this.stage;
    if (rays.length > 0) this.rays.set(rays[Math.min(light, rays.length - 1)]);
    this.draw();
  }

  // The map bin at a position of the page: surface, bin and its position on the body.
  pick(clientX, clientY) {
    if (!this.painting) return null;
    const box = this.canvas.getBoundingClientRect();
    const at = new Vector2((clientX - box.left) / box.width * 2 - 1, 1 - (clientY - box.top) / box.height * 2);
    const caster = new Raycaster();
    caster.setFromCamera(at, this.camera);
    const [hit] = caster.intersectObject(this.painting.group, true);
    if (!hit?.uv) return null;
    const { surface } = hit.object.userData;
    return { surface, bin: surface.grid.binAt(hit.uv.x, hit.uv.y) };
  }

  // Marks a position on a surface; null: none.
  mark(surface, u, v) {
    const place = surface?.placeOf(u, v) ?? null;
    this.marker.visible = place !== null;
    if (place) this.marker.position.copy(place);
    this.draw();
  }

  // Directions of the lab's axes on the screen: x right, y down, z towards the viewer.
  axes() {
    const inverse = this.camera.quaternion.clone().invert();
    return [[1, 0, 0], [0, 1, 0], [0, 0, 1]].map((axis) => {
      const seen = new Vector3(...axis).applyQuaternion(inverse);
      return [seen.x, -seen.y, seen.z];
    });
  }

  // Position of a point of the first body on the canvas, in canvas pixels.
  onScreen(point) {
    const at = point.clone().applyQuaternion(this.bodies[0].quaternion).project(this.camera);
    return [(at.x + 1) / 2 * this.canvas.clientWidth, (1 - at.y) / 2 * this.canvas.clientHeight];
  }

  // Draws once before the next frame, however many times it is called.
  draw() {
    if (this.waiting) return;
    this.waiting = true;
    requestAnimationFrame(() => {
      this.waiting = false;
      this.renderer.render(this.scene, this.camera);
      this.ondraw?.();
    });
  }
}
