// The layer of the points: all points are drawn first, by the graphics card or by the processor, get eye-dome lighting,
// and are then put into the picture of everything else, each at its depth.
import {
  BufferAttribute,
  BufferGeometry,
  type Color,
  DataTexture,
  DepthTexture,
  FloatType,
  Mesh,
  NearestFilter,
  type PerspectiveCamera,
  Matrix4,
  RedFormat,
  RGBAFormat,
  type Scene,
  ShaderMaterial,
  Vector2,
  type WebGLRenderer,
  WebGLRenderTarget,
} from 'three';
import type { Cloud } from './cloud';
import { type Display, PICTURE_MASK, PLAIN_MASK, POINTS, QUAD } from './display';
import { DARKEST, DOME, type Filter, type Pane, Splatter } from './splat';

export const DRAWERS = ['automatic', 'graphics card', 'processor'] as const;
export type Drawer = (typeof DRAWERS)[number];

const VERTEX = /* glsl */ `
  void main() { gl_Position = vec4(position.xy, 0.0, 1.0); }
`;

const FRAGMENT = /* glsl */ `
  uniform sampler2D points;
  uniform sampler2D depths;
  uniform bool splatted;
  uniform int dome;
  /** Depth = planes.x - planes.y / distance. */
  uniform vec2 planes;
  float nearness(ivec2 at, float own) {
    float z = texelFetch(depths, at, 0).r;
    return z >= 1.0 ? own : planes.x - z;
  }
  float nearer(ivec2 at, ivec2 by, float own) {
    return max(0.0, nearness(at + by, own) + nearness(at - by, own) - 2.0 * own);
  }
  void main() {
    ivec2 at = ivec2(gl_FragCoord.xy);
    vec4 colour = texelFetch(points, at, 0);
    if (colour.a < 0.5) discard;
    float light = 1.0;
    float depth = 0.0;
    if (splatted) {
      depth = planes.x - planes.y * texelFetch(depths, at, 0).r;
    } else {
      depth = texelFetch(depths, at, 0).r;
      float own = planes.x - depth;
      float dark = dome > 0 ? nearer(at, ivec2(dome, 0), own) + nearer(at, ivec2(0, dome), own) : 0.0;
      light = max(${DARKEST.toFixed(2)}, own / (own + ${(DOME / 2).toFixed(1)} * dark));
    }
    gl_FragDepth = depth;
    gl_FragColor = vec4(colour.rgb * light, 1.0);
  }
`;

const COPY_VERTEX = /* glsl */ `
  varying vec2 at;
  void main() {
    at = 0.5 + 0.5 * position.xy;
    gl_Position = vec4(position.xy, 0.0, 1.0);
  }
`;

// Where there are only points, the picture of the processor is the whole picture: copying it is all that is left to do.
const COPY_FRAGMENT = /* glsl */ `
  uniform sampler2D points;
  varying vec2 at;
  void main() { gl_FragColor = texture2D(points, at); }
`;

/** A colour as the bytes red, green, blue and opacity. */
function wordOf(colour: Color): number {
  const hex = colour.getHex();
  return (0xff000000 | ((hex & 255) << 16) | (hex & 0xff00) | (hex >> 16)) >>> 0;
}

/** Whether a program draws in place of a graphics card. */
function isSoftware(gl: WebGL2RenderingContext): boolean {
  const facts = gl.getExtension('WEBGL_debug_renderer_info');
  const name = String(gl.getParameter(facts ? facts.UNMASKED_RENDERER_WEBGL : gl.RENDERER));
  return /swiftshader|llvmpipe|softpipe|software|basic render/i.test(name);
}

export class PointsLayer {
  readonly quad: Mesh;
  readonly software: boolean;
  lighting = true;
  drawer: Drawer = 'automatic';
  private readonly splatter = new Splatter();
  private readonly target = new WebGLRenderTarget(1, 1, { minFilter: NearestFilter, magFilter: NearestFilter });
  private readonly look: ShaderMaterial;
  private readonly copy: ShaderMaterial;
  /** Whether there is anything but points in the picture. */
  private deep = false;
  private readonly size = new Vector2();
  private colours: DataTexture | null = null;
  private nearness: DataTexture | null = null;

  constructor(
    private readonly renderer: WebGLRenderer,
    private readonly display: Display,
  ) {
    this.software = isSoftware(renderer.getContext() as WebGL2RenderingContext);
    this.target.depthTexture = new DepthTexture(1, 1);
    const uniforms = { points: { value: null }, depths: { value: null }, splatted: { value: false }, dome: { value: 0 }, planes: { value: new Vector2() } };
    this.look = new ShaderMaterial({ uniforms, vertexShader: VERTEX, fragmentShader: FRAGMENT, toneMapped: false });
    const toCopy = { uniforms: { points: { value: null } }, vertexShader: COPY_VERTEX, fragmentShader: COPY_FRAGMENT };
    this.copy = new ShaderMaterial({ ...toCopy, toneMapped: false, depthTest: false, depthWrite: false });
    const triangle = new BufferGeometry();
    triangle.setAttribute('position', new BufferAttribute(new Float32Array([-1, -1, 0, 3, -1, 0, -1, 3, 0]), 3));
    this.quad = new Mesh(triangle, this.look);
    this.quad.frustumCulled = false;
    this.quad.renderOrder = 5; // behind it come marks
    this.quad.raycast = () => {};
    this.quad.layers.set(QUAD);
  }

  /** Whether the processor draws the points. */
  get splats(): boolean {
    return this.drawer === 'processor' || (this.drawer === 'automatic' && this.software);
  }

  /**
   * Begins a picture; `size` is the diameter of a point in pixels, and `deep` tells whether there is anything but points
   * in the picture.
   */
  begin(size: number, deep: boolean, background: Color): void {
    this.deep = deep;
    this.renderer.getDrawingBufferSize(this.size);
    const { x: width, y: height } = this.size;
    this.quad.visible = false;
    this.look.uniforms.dome!.value = this.lighting ? Math.max(1, Math.round(size / 2)) : 0;
    if (this.splats) this.splatter.begin(width, height, deep ? 0 : wordOf(background));
    else this.target.setSize(width, height);
  }

  /** Draws points into the layer, where the camera's picture lies (in pixels of the canvas). */
  add(scene: Scene, camera: PerspectiveCamera, clouds: Cloud[], pane: Pane): void {
    this.quad.visible ||= clouds.length > 0;
    if (this.splats) this.splat(camera, clouds, pane);
    else this.render(scene, camera, pane);
  }

  /** Ends the layer. */
  finish({ near, far }: PerspectiveCamera): void {
    const { uniforms } = this.look;
    (uniforms.planes!.value as Vector2).set(far / (far - near), (far * near) / (far - near));
    uniforms.splatted!.value = this.splats;
    this.quad.material = this.splats && !this.deep ? this.copy : this.look;
    if (!this.splats) {
      uniforms.points!.value = this.target.texture;
      uniforms.depths!.value = this.target.depthTexture;
    } else if (this.quad.visible) {
      this.upload();
    }
  }

  /** Draws the scene with the layer in it. */
  show(scene: Scene, camera: PerspectiveCamera): void {
    camera.layers.mask = PICTURE_MASK;
    this.renderer.render(scene, camera);
    camera.layers.mask = PLAIN_MASK;
  }

  private splat(camera: PerspectiveCamera, clouds: Cloud[], pane: Pane): void {
    const { splatter, display } = this;
    const clip = new Matrix4().multiplyMatrices(camera.projectionMatrix, camera.matrixWorldInverse);
    const [low, high] = display.uniforms.sliceRange.value.toArray();
    const axis = display.uniforms.sliceNormal.value.toArray().indexOf(1);
    const slice = low > -1e29 || high < 1e29 ? { axis, low, high } : null;
    for (const cloud of clouds) {
      const filter: Filter = { times: cloud.times, slice };
      for (const batch of cloud.batches()) splatter.draw(batch, clip, pane, Math.max(1, cloud.size), filter);
    }
  }

  /** Lights what the processor drew, and hands it to the graphics card. */
  private upload(): void {
    const { splatter, look } = this;
    if (this.lighting) splatter.shade(look.uniforms.dome!.value as number);
    const { width, height } = splatter;
    if (this.nearness?.image.data !== splatter.near) {
      this.colours?.dispose();
      this.nearness?.dispose();
      this.colours = new DataTexture(new Uint8Array(splatter.colour.buffer), width, height, RGBAFormat);
      this.nearness = new DataTexture(splatter.near, width, height, RedFormat, FloatType);
    }
    this.colours!.needsUpdate = true;
    if (this.deep) this.nearness!.needsUpdate = true;
    look.uniforms.points!.value = this.copy.uniforms.points!.value = this.colours;
    look.uniforms.depths!.value = this.nearness;
  }

  private render(scene: Scene, camera: PerspectiveCamera, pane: Pane): void {
    const { renderer, target } = this;
    const background = scene.background;
    scene.background = null;
    target.viewport.set(pane.left, 0, pane.width, this.size.y);
    target.scissor.set(pane.from, 0, pane.to - pane.from, this.size.y);
    target.scissorTest = true;
    camera.layers.set(POINTS);
    renderer.setRenderTarget(target);
    renderer.setClearColor(0, 0);
    renderer.render(scene, camera);
    renderer.setRenderTarget(null);
    camera.layers.mask = PLAIN_MASK;
    scene.background = background;
  }
}
