// A picture on a canvas by WebGL2. The first program adds up the lights of each pixel, in linear light; the second draws the display in
// perspective: nearest pixels where they are large, means where they are small.

import type { Triple } from "../model/colour.ts";
import { extent } from "../model/perspective.ts";
import type { Planes } from "../model/seen.ts";
import { AGE, LEAST_DEG, MOST_DEG, PIGMENT } from "../model/glare.ts";
import { LARGE_PX, type Lit, type Painter, type Scenery, type SubPixels } from "./seen.ts";

/** Largest numbers of lights, mirror images, and windows of sub-pixels. */
const LIGHTS = 18;
const LAMPS = 16;
const WINDOWS = 16;

const EVERYWHERE = `#version 300 es
void main() {
  gl_Position = vec4(gl_VertexID == 1 ? 3.0 : -1.0, gl_VertexID == 2 ? 3.0 : -1.0, 0.0, 1.0);
}`;

const ADD_UP = `#version 300 es
precision highp float;
precision highp sampler2DArray;
uniform sampler2DArray planes;
uniform int count;
uniform float factors[${LIGHTS}];
uniform vec3 added;
uniform mat3 matrix;
out vec4 colour;
void main() {
  vec3 xyz = added;
  for (int i = 0; i < count; i++) xyz += factors[i] * texelFetch(planes, ivec3(gl_FragCoord.xy, i), 0).rgb;
  colour = vec4(matrix * xyz, 1.0);
}`;

const DRAW = `#version 300 es
precision highp float;
precision highp usampler2D;
uniform sampler2D picture;
uniform usampler2D states;
uniform vec2 size;
uniform vec2 canvas;
uniform vec2 middle;
uniform float scale;
uniform vec3 place, right, up, forward;
uniform float eyeDistance, tall;
uniform int lampCount, veilCount;
uniform vec4 lamps[${LAMPS}];
uniform vec3 lampLight[${LAMPS}];
uniform vec4 veilFrom[${LAMPS}];
uniform vec3 veilLight[${LAMPS}];
uniform int windowCount;
uniform vec4 windows[${WINDOWS}];
uniform sampler2D lightOfWindows;
out vec4 colour;

// What is too bright keeps its hue, as displayed() in model/colour.ts.
vec3 encoded(vec3 light) {
  vec3 c = max(light, 0.0);
  c /= max(1.0, max(c.r, max(c.g, c.b)));
  return mix(1.055 * pow(c, vec3(1.0 / 2.4)) - 0.055, 12.92 * c, vec3(lessThanEqual(c, vec3(0.0031308))));
}

float glare(float theta) {
  float t = clamp(theta, ${LEAST_DEG.toFixed(4)}, ${MOST_DEG.toFixed(1)});
  float aged = ${(1 + (AGE / 62.5) ** 4).toFixed(8)};
  return 10.0 / (t * t * t) + (5.0 / (t * t) + ${(0.1 * PIGMENT).toFixed(8)} / t) * aged + ${(0.0025 * PIGMENT).toFixed(8)};
}

// Mirror images of lamps, and the veil in the eye, at a point of the display.
vec3 inTheEye(vec2 point) {
  vec3 light = vec3(0.0);
  vec3 sight = normalize(vec3(point, 0.0) - place);
  for (int i = 0; i < lampCount; i++)
    if (dot(vec3(sight.xy, -sight.z), lamps[i].xyz) > lamps[i].w) light += lampLight[i];
  for (int i = 0; i < veilCount; i++) {
    float apart = 2.0 * asin(min(1.0, 0.5 * length(veilFrom[i].xyz - sight)));
    light += veilLight[i] * max(0.0, dot(veilFrom[i].xyz, sight)) * glare(max(veilFrom[i].w, degrees(apart)));
  }
  return light;
}

void main() {
  vec2 at = (gl_FragCoord.xy - 0.5 * canvas) / scale + middle;
  vec3 ray = forward * eyeDistance + right * at.x + up * at.y;
  float depth = -place.z / ray.z;
  vec2 point = place.xy + depth * ray.xy;
  vec2 pixel = vec2(point.x + 0.5, 0.5 - point.y / tall) * size;
  vec2 across = dFdx(pixel), along = dFdy(pixel);
  vec2 width = abs(across) + abs(along);
  // The fraction of the canvas's pixel that the display covers.
  vec2 inner = clamp(min(pixel, size - pixel) / max(width, 1e-6) + 0.5, 0.0, 1.0);
  float covered = depth > 0.0 ? inner.x * inner.y : 0.0;
  if (covered <= 0.0) {
    colour = vec4(0.0);
    return;
  }
  pixel = clamp(pixel, vec2(0.0), size - 1e-3);
  // Between two pixels that are larger than those of the canvas, the border is as wide as a pixel of the canvas.
  vec2 border = floor(pixel + 0.5);
  vec2 near = border + clamp((pixel - border) / max(width, 1e-6), -0.5, 0.5);
  vec2 sampled = mix(pixel, near, vec2(lessThan(width, vec2(1.0))));
  vec3 light = textureGrad(picture, sampled / size, across / size, along / size).rgb;
  if (windowCount > 0 && max(width.x, width.y) * ${LARGE_PX.toFixed(1)} < 1.0) {
    vec2 inside = vec2(fract(pixel.x), 1.0 - fract(pixel.y));
    int window = windowCount;
    for (int i = 0; i < windowCount; i++)
      if (all(greaterThanEqual(inside, windows[i].xy)) && all(lessThan(inside, windows[i].zw))) window = i;
    int state = int(texelFetch(states, ivec2(pixel), 0).r);
    light = texelFetch(lightOfWindows, ivec2(window, state), 0).rgb;
  }
  if (lampCount + veilCount > 0) light += inTheEye(point);
  colour = vec4(encoded(light) * covered, covered);
}`;

type GL = WebGL2RenderingContext;

/** Whether the processor draws. */
function isSoftware(gl: GL): boolean {
  const about = gl.getExtension("WEBGL_debug_renderer_info");
  return /swiftshader|llvmpipe|software/i.test(String(gl.getParameter(about ? about.UNMASKED_RENDERER_WEBGL : gl.RENDERER)));
}

function program(gl: GL, fragment: string): WebGLProgram {
  const made = gl.createProgram()!;
  for (const [kind, text] of [
    [gl.VERTEX_SHADER, EVERYWHERE],
    [gl.FRAGMENT_SHADER, fragment],
  ] as const) {
    const shader = gl.createShader(kind)!;
    gl.shaderSource(shader, text);
    gl.compileShader(shader);
    gl.attachShader(made, shader);
  }
  gl.linkProgram(made);
  if (!gl.getProgramParameter(made, gl.LINK_STATUS)) throw new Error(gl.getProgramInfoLog(made) ?? "");
  return made;
}

function texture(gl: GL, target: number, filter: number, small = filter): WebGLTexture {
  const made = gl.createTexture();
  gl.bindTexture(target, made);
  gl.texParameteri(target, gl.TEXTURE_MAG_FILTER, filter);
  gl.texParameteri(target, gl.TEXTURE_MIN_FILTER, small);
  gl.texParameteri(target, gl.TEXTURE_WRAP_S, gl.CLAMP_TO_EDGE);
  gl.texParameteri(target, gl.TEXTURE_WRAP_T, gl.CLAMP_TO_EDGE);
  return made;
}

/** Whether WebGL computes with 16-bit floating point numbers. */
const isAble = (gl: GL | null): gl is GL =>
  gl !== null &&
  (gl.getExtension("EXT_color_buffer_float") ?? gl.getExtension("EXT_color_buffer_half_float")) !== null;

let able: boolean | null = null;

/**
 * Returns a painter by WebGL2; null if the browser has none that can draw the picture, or none by a graphics processor, unless it is wanted
 * `anyhow`.
 */
export function onGraphics(canvas: HTMLCanvasElement, anyhow: boolean): Painter | null {
  // A canvas with a WebGL context can have no other one: another canvas is tried first.
  if (able === null) {
    const trial = document.createElement("canvas").getContext("webgl2");
    able = isAble(trial) && (anyhow || !isSoftware(trial));
    trial?.getExtension("WEBGL_lose_context")?.loseContext();
  }
  const gl = able ? canvas.getContext("webgl2", { antialias: false }) : null;
  return gl && isAble(gl) ? new Graphics(gl, canvas) : null;
}

class Graphics implements Painter {
  readonly name = "WebGL2";
  private readonly adding: WebGLProgram;
  private readonly drawing: WebGLProgram;
  private readonly target: WebGLFramebuffer;
  private planes: WebGLTexture | null = null;
  private picture: WebGLTexture | null = null;
  private states: WebGLTexture | null = null;
  private windows: WebGLTexture | null = null;
  private shown: Planes | null = null;
  private former: Lit | null = null;
  private formerSub: SubPixels | null = null;
  private readonly places = new Map<string, WebGLUniformLocation | null>();

  constructor(
    private readonly gl: GL,
    private readonly canvas: HTMLCanvasElement,
  ) {
    this.adding = program(gl, ADD_UP);
    this.drawing = program(gl, DRAW);
    this.target = gl.createFramebuffer();
    gl.pixelStorei(gl.UNPACK_ALIGNMENT, 1);
    // Every sampler needs a texture of its kind, also where it is not read.
    this.loadSubPixels({ states: new Uint8Array(1), windows: [], light: [[[0, 0, 0]]] }, [1, 1]);
  }

  draw(of: Scenery): void {
    if (this.gl.isContextLost()) return;
    this.load(of.lit.picture);
    this.addUp(of.lit);
    if (of.subPixels) this.loadSubPixels(of.subPixels, of.lit.picture.size);
    this.paint(of);
  }

  release(): void {
    this.gl.getExtension("WEBGL_lose_context")?.loseContext();
  }

  private place(of: WebGLProgram, name: string): WebGLUniformLocation | null {
    const key = `${of === this.adding} ${name}`;
    if (!this.places.has(key)) this.places.set(key, this.gl.getUniformLocation(of, name));
    return this.places.get(key)!;
  }

  private load(picture: Planes): void {
    if (this.shown === picture) return;
    const { gl } = this;
    const [columns, rows] = picture.size;
    for (const old of [this.planes, this.picture]) gl.deleteTexture(old);
    gl.activeTexture(gl.TEXTURE0);
    this.planes = texture(gl, gl.TEXTURE_2D_ARRAY, gl.NEAREST);
    gl.texStorage3D(gl.TEXTURE_2D_ARRAY, 1, gl.RGB16F, columns, rows, picture.planes.length);
    picture.planes.forEach((plane, i) =>
      gl.texSubImage3D(gl.TEXTURE_2D_ARRAY, 0, 0, 0, i, columns, rows, 1, gl.RGB, gl.HALF_FLOAT, plane),
    );
    this.picture = texture(gl, gl.TEXTURE_2D, gl.LINEAR, gl.LINEAR_MIPMAP_LINEAR);
    const levels = 1 + Math.floor(Math.log2(Math.max(columns, rows)));
    gl.texStorage2D(gl.TEXTURE_2D, levels, gl.RGBA16F, columns, rows);
    const oblique = gl.getExtension("EXT_texture_filter_anisotropic");
    if (oblique) gl.texParameterf(gl.TEXTURE_2D, oblique.TEXTURE_MAX_ANISOTROPY_EXT, 8);
    this.shown = picture;
    this.former = null;
    this.formerSub = null;
  }

  private addUp(lit: Lit): void {
    const now = [lit.factors, lit.added, lit.matrix].join();
    if (this.former && [this.former.factors, this.former.added, this.former.matrix].join() === now) return;
    this.former = lit;
    const { gl, adding } = this;
    const [columns, rows] = lit.picture.size;
    gl.useProgram(adding);
    gl.uniform1i(this.place(adding, "planes"), 0);
    gl.uniform1i(this.place(adding, "count"), Math.min(LIGHTS, lit.factors.length));
    gl.uniform1fv(this.place(adding, "factors"), lit.factors.slice(0, LIGHTS));
    gl.uniform3fv(this.place(adding, "added"), lit.added);
    // Columns first.
    const columnsFirst = [0, 1, 2].flatMap((k) => lit.matrix.map((row) => row[k as 0 | 1 | 2]));
    gl.uniformMatrix3fv(this.place(adding, "matrix"), false, columnsFirst);
    gl.activeTexture(gl.TEXTURE0);
    gl.bindTexture(gl.TEXTURE_2D_ARRAY, this.planes);
    gl.bindFramebuffer(gl.FRAMEBUFFER, this.target);
    gl.framebufferTexture2D(gl.FRAMEBUFFER, gl.COLOR_ATTACHMENT0, gl.TEXTURE_2D, this.picture, 0);
    gl.viewport(0, 0, columns, rows);
    gl.drawArrays(gl.TRIANGLES, 0, 3);
    gl.bindFramebuffer(gl.FRAMEBUFFER, null);
    gl.bindTexture(gl.TEXTURE_2D, this.picture);
    gl.generateMipmap(gl.TEXTURE_2D);
  }

  private loadSubPixels(of: SubPixels, [columns, rows]: Planes["size"]): void {
    if (of === this.formerSub) return;
    this.formerSub = of;
    const { gl } = this;
    for (const old of [this.states, this.windows]) gl.deleteTexture(old);
    gl.activeTexture(gl.TEXTURE1);
    this.states = texture(gl, gl.TEXTURE_2D, gl.NEAREST);
    gl.texStorage2D(gl.TEXTURE_2D, 1, gl.R8UI, columns, rows);
    gl.texSubImage2D(gl.TEXTURE_2D, 0, 0, 0, columns, rows, gl.RED_INTEGER, gl.UNSIGNED_BYTE, of.states);
    gl.activeTexture(gl.TEXTURE2);
    this.windows = texture(gl, gl.TEXTURE_2D, gl.NEAREST);
    const [across, down] = [of.windows.length + 1, of.light.length];
    gl.texStorage2D(gl.TEXTURE_2D, 1, gl.RGBA32F, across, down);
    const light = Float32Array.from(of.light.flatMap((state) => state.flatMap((one: Triple) => [...one, 0])));
    gl.texSubImage2D(gl.TEXTURE_2D, 0, 0, 0, across, down, gl.RGBA, gl.FLOAT, light);
  }

  private paint({ lit, camera, frame, mirrors, veils, subPixels }: Scenery): void {
    const { gl, drawing } = this;
    const at = (name: string) => this.place(drawing, name);
    gl.viewport(0, 0, this.canvas.width, this.canvas.height);
    gl.useProgram(drawing);
    gl.activeTexture(gl.TEXTURE0);
    gl.bindTexture(gl.TEXTURE_2D, this.picture);
    gl.uniform1i(at("picture"), 0);
    gl.activeTexture(gl.TEXTURE1);
    gl.bindTexture(gl.TEXTURE_2D, this.states);
    gl.uniform1i(at("states"), 1);
    gl.activeTexture(gl.TEXTURE2);
    gl.bindTexture(gl.TEXTURE_2D, this.windows);
    gl.uniform1i(at("lightOfWindows"), 2);
    gl.uniform2fv(at("size"), lit.picture.size);
    gl.uniform2fv(at("canvas"), frame.canvas);
    gl.uniform2fv(at("middle"), frame.middle);
    gl.uniform1f(at("scale"), frame.scale);
    for (const name of ["place", "right", "up", "forward"] as const) gl.uniform3fv(at(name), camera[name]);
    gl.uniform1f(at("eyeDistance"), camera.distance);
    gl.uniform1f(at("tall"), camera.height);
    const some = mirrors.slice(0, LAMPS);
    gl.uniform1i(at("lampCount"), some.length);
    if (some.length > 0) {
      gl.uniform4fv(at("lamps"), some.flatMap(({ towards, cosine }) => [...towards, cosine]));
      gl.uniform3fv(at("lampLight"), some.flatMap(({ light }) => [...light]));
    }
    const spread = veils.slice(0, LAMPS);
    gl.uniform1i(at("veilCount"), spread.length);
    if (spread.length > 0) {
      gl.uniform4fv(at("veilFrom"), spread.flatMap(({ from, radius_deg }) => [...from, radius_deg]));
      gl.uniform3fv(at("veilLight"), spread.flatMap(({ light }) => [...light]));
    }
    const windows = subPixels && subPixels.windows.length <= WINDOWS ? subPixels.windows : [];
    gl.uniform1i(at("windowCount"), windows.length);
    if (windows.length > 0) gl.uniform4fv(at("windows"), windows.flat());
    gl.clearColor(0, 0, 0, 0);
    gl.clear(gl.COLOR_BUFFER_BIT);
    gl.enable(gl.SCISSOR_TEST);
    gl.scissor(...extent(camera, frame));
    gl.drawArrays(gl.TRIANGLES, 0, 3);
    gl.disable(gl.SCISSOR_TEST);
  }
}
