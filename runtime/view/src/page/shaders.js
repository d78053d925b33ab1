// Programs of the graphics processor: shapes, tubes and the ground, lit alike; the same vertices cast the shadow.

const HEAD = `#version 300 es
precision highp float;
precision highp sampler2DShadow;
uniform mat4 camera;
uniform vec3 eye;
uniform vec3 light;
`;

/** Light from the sky and the ground, from the sun, and a little from the eye, so that no side is dark. */
const LIT = `
vec3 lit(vec3 base, vec3 n, vec3 v, float gloss) {
  float sky = 0.5 + 0.5 * n.z;
  float sun = max(dot(n, light), 0.0);
  float shine = pow(max(dot(n, normalize(light + v)), 0.0), 40.0) * gloss;
  return base * (mix(0.38, 0.64, sky) + 0.44 * sun + 0.2 * max(dot(n, v), 0.0)) + shine;
}`;

const SHAPE_VERTEX = `${HEAD}
layout(location=0) in vec3 corner;
layout(location=1) in vec3 direction;
layout(location=2) in float cap;
layout(location=3) in vec3 place;
layout(location=4) in vec4 turn;
layout(location=5) in vec4 size;
layout(location=6) in vec4 colour;
out vec3 at; out vec3 n; out vec4 tint;
vec3 turned(vec3 p) { return p + 2.0 * cross(turn.yzw, cross(turn.yzw, p) + turn.x * p); }
void main() {
  at = place + turned(corner * size.xyz + vec3(0.0, 0.0, cap * size.w));
  n = turned(direction / max(size.xyz, vec3(1e-5)));
  tint = colour;
  gl_Position = camera * vec4(at, 1.0);
}`;

const SHAPE_FRAGMENT = `${HEAD}${LIT}
uniform float shell;
in vec3 at; in vec3 n; in vec4 tint;
out vec4 pixel;
void main() {
  vec3 v = normalize(eye - at);
  vec3 m = normalize(n);
  if (dot(m, v) < 0.0) m = -m;
  float edge = pow(1.0 - max(dot(m, v), 0.0), 2.2);
  float alpha = mix(tint.a, tint.a * mix(0.3, 1.0, edge), shell);
  vec3 c = lit(tint.rgb, m, v, mix(0.12, 0.04, shell));
  pixel = vec4(c * alpha, alpha);
}`;

const TUBE_VERTEX = `${HEAD}
precision highp sampler2D;
uniform sampler2D places;
uniform sampler2D normals;
uniform sampler2D colours;
uniform int rings;
layout(location=0) in vec2 ringAngle;
out vec3 at; out vec3 n; out vec4 tint; out float belly;
void main() {
  int ring = int(ringAngle.x);
  int row = gl_InstanceID;
  vec4 p = texelFetch(places, ivec2(ring, row), 0);
  vec4 m = texelFetch(normals, ivec2(ring, row), 0);
  vec4 a = texelFetch(places, ivec2(max(ring - 1, 0), row), 0);
  vec4 b = texelFetch(places, ivec2(min(ring + 1, rings - 1), row), 0);
  vec3 along = b.xyz - a.xyz;
  float span = max(length(along), 1e-6);
  vec3 t = along / span;
  vec3 side = normalize(m.xyz - t * dot(m.xyz, t) + vec3(1e-7));
  vec3 out_ = cos(ringAngle.y) * side + sin(ringAngle.y) * cross(t, side);
  at = p.xyz + out_ * p.w;
  n = normalize(out_ - t * clamp((b.w - a.w) / span, -1.0, 1.0));
  tint = texelFetch(colours, ivec2(0, row), 0);
  belly = m.w;
  gl_Position = camera * vec4(at, 1.0);
}`;

const TUBE_FRAGMENT = `${HEAD}${LIT}
uniform vec3 tendon;
in vec3 at; in vec3 n; in vec4 tint; in float belly;
out vec4 pixel;
void main() {
  vec3 v = normalize(eye - at);
  vec3 m = normalize(n);
  if (dot(m, v) < 0.0) m = -m;
  vec3 base = mix(tendon, tint.rgb, smoothstep(0.1, 0.6, belly));
  // Muscles that are not chosen step back.
  if (tint.a < 0.5) base = mix(base, vec3(dot(base, vec3(0.33))), 0.75) * 0.8;
  vec3 c = lit(base, m, v, 0.18) * (0.82 + 0.18 * max(dot(m, v), 0.0));
  pixel = vec4(c, 1.0);
}`;

const GROUND_VERTEX = `${HEAD}
uniform vec3 centre;
layout(location=0) in vec2 corner;
out vec3 at;
void main() {
  at = vec3(centre.xy + corner * 30.0, 0.0);
  gl_Position = camera * vec4(at, 1.0);
}`;

const GROUND_FRAGMENT = `${HEAD}
uniform vec3 centre;
uniform vec3 ground; uniform vec3 line; uniform vec3 sky;
uniform mat4 sun;
uniform sampler2DShadow shadow;
in vec3 at;
out vec4 pixel;
float grid(float step_, float width) {
  vec2 p = at.xy / step_;
  vec2 d = abs(fract(p - 0.5) - 0.5) / max(fwidth(p), vec2(1e-5));
  return 1.0 - min(min(d.x, d.y) / width, 1.0);
}
void main() {
  vec4 s = sun * vec4(at, 1.0);
  vec3 q = s.xyz / s.w * 0.5 + 0.5;
  float lit = 0.0;
  if (all(lessThan(abs(q - 0.5), vec3(0.5)))) {
    // Each of the nine reads blends four neighbours.
    for (int x = -1; x <= 1; x++) for (int y = -1; y <= 1; y++)
      lit += texture(shadow, vec3(q.xy + vec2(float(x), float(y)) * 0.0022, q.z - 0.002));
    lit /= 9.0;
  } else lit = 1.0;
  vec3 c = mix(ground, line, 0.7 * grid(1.0, 1.4) + 0.25 * grid(0.25, 1.0));
  c *= mix(0.62, 1.0, lit);
  float far = smoothstep(3.0, 14.0, length(at.xy - centre.xy));
  pixel = vec4(mix(c, sky, far), 1.0);
}`;

const DEPTH_FRAGMENT = `#version 300 es
precision highp float;
void main() {}`;

function compile(gl, vertex, fragment) {
  const program = gl.createProgram();
  for (const [kind, text] of [[gl.VERTEX_SHADER, vertex], [gl.FRAGMENT_SHADER, fragment]]) {
    const shader = gl.createShader(kind);
    gl.shaderSource(shader, text);
    gl.compileShader(shader);
    gl.attachShader(program, shader);
  }
  gl.linkProgram(program);
  if (!gl.getProgramParameter(program, gl.LINK_STATUS)) throw new Error(`a shader does not link: ${gl.getProgramInfoLog(program)}`);
  const places = new Map();
  const count = gl.getProgramParameter(program, gl.ACTIVE_UNIFORMS);
  for (let index = 0; index < count; index++) {
    const { name } = gl.getActiveUniform(program, index);
    places.set(name, gl.getUniformLocation(program, name));
  }
  return { program, at: (name) => places.get(name) ?? null };
}
