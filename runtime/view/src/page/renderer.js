// Draws stages with WebGL 2: shadow, what is solid, muscles, then what shines through.

const SHADOW = 1024;
const LIGHT = unit([0.35, -0.45, 1.0]);

class Renderer {
  constructor(canvas) {
    const gl = canvas.getContext("webgl2", { antialias: true, alpha: false, powerPreference: "high-performance" });
    if (!gl) throw new Error("this browser has no WebGL 2, which the picture needs; the charts work without it");
    this.gl = gl;
    this.canvas = canvas;
    this.programs = {
      shape: compile(gl, SHAPE_VERTEX, SHAPE_FRAGMENT),
      tube: compile(gl, TUBE_VERTEX, TUBE_FRAGMENT),
      ground: compile(gl, GROUND_VERTEX, GROUND_FRAGMENT),
      shapeDepth: compile(gl, SHAPE_VERTEX, DEPTH_FRAGMENT),
      tubeDepth: compile(gl, TUBE_VERTEX, DEPTH_FRAGMENT),
    };
    this.solids = { balls: new Solid(gl, ball(6, 20)), small: new Solid(gl, ball(3, 10)), boxes: new Solid(gl, box()), cylinders: new Solid(gl, cylinder(32)), bones: new Solid(gl, bone(8)), arrows: new Solid(gl, arrow(14)) };
    this.tubes = tubeGrid(gl);
    this.ground = gl.createVertexArray();
    gl.bindVertexArray(this.ground);
    gl.bindBuffer(gl.ARRAY_BUFFER, gl.createBuffer());
    gl.bufferData(gl.ARRAY_BUFFER, new Float32Array([-1, -1, 1, -1, -1, 1, 1, 1]), gl.STATIC_DRAW);
    gl.enableVertexAttribArray(0);
    gl.vertexAttribPointer(0, 2, gl.FLOAT, false, 0, 0);
    gl.bindVertexArray(null);
    this.textures = { places: dataTexture(gl), normals: dataTexture(gl), colours: dataTexture(gl) };
    this.shadow = shadowTarget(gl);
  }

  /** Draws each stage in its own column. */
  draw(stages, cameraOf, theme, show) {
    const { gl, canvas } = this;
    const ratio = Math.min(window.devicePixelRatio || 1, 2);
    const [width, height] = [Math.max(1, Math.round(canvas.clientWidth * ratio)), Math.max(1, Math.round(canvas.clientHeight * ratio))];
    if (canvas.width !== width || canvas.height !== height) [canvas.width, canvas.height] = [width, height];
    gl.clearColor(...theme.sky, 1);
    gl.disable(gl.SCISSOR_TEST);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    stages.forEach((stage, index) => {
      const left = Math.round((width * index) / stages.length);
      const area = [left, 0, Math.round((width * (index + 1)) / stages.length) - left, height];
      this.stage(stage, cameraOf(stage, area[2] / area[3]), theme, show, area);
    });
  }

  stage(stage, camera, theme, show, area) {
    const { gl } = this;
    const { tubes, lists } = stage;
    upload(gl, this.textures.places, RINGS, tubes.count, tubes.places);
    upload(gl, this.textures.normals, RINGS, tubes.count, tubes.normals);
    upload(gl, this.textures.colours, 1, tubes.count, stage.colours);
    gl.enable(gl.DEPTH_TEST);
    gl.disable(gl.BLEND);
    const sun = this.castShadow(stage, show);
    gl.enable(gl.SCISSOR_TEST);
    gl.scissor(...area);
    gl.viewport(...area);
    if (stage.recording.anatomy.ground) this.drawGround(stage, camera, theme, sun);
    this.begin(this.programs.shape, camera);
    gl.uniform1f(this.programs.shape.at("shell"), 0);
    this.copies(stage, lists.solid);
    if (show.muscles) this.drawTubes(this.programs.tube, camera, tubes.count, theme);
    gl.enable(gl.BLEND);
    gl.blendFunc(gl.ONE, gl.ONE_MINUS_SRC_ALPHA);
    this.begin(this.programs.shape, camera);
    gl.uniform1f(this.programs.shape.at("shell"), 1);
    gl.depthFunc(gl.LEQUAL);
    // Only the nearest layer of what shines through is seen: its depth first, then its colour.
    for (const layer of [lists.skin, lists.ghost]) {
      gl.colorMask(false, false, false, false);
      this.copies(stage, layer);
      gl.colorMask(true, true, true, true);
      this.copies(stage, layer);
    }
    gl.depthFunc(gl.LESS);
    gl.disable(gl.BLEND);
    gl.disable(gl.SCISSOR_TEST);
  }

  begin({ program, at }, { matrix, eye }) {
    const { gl } = this;
    gl.useProgram(program);
    gl.uniformMatrix4fv(at("camera"), false, matrix);
    if (at("eye")) gl.uniform3fv(at("eye"), eye);
    if (at("light")) gl.uniform3fv(at("light"), LIGHT);
  }

  copies(stage, lists) {
    for (const [name, solid] of Object.entries(this.solids)) solid.draw(lists[name]);
    stage.meshes.forEach((mesh, index) => mesh.draw(lists.meshes[index]));
  }

  drawTubes(program, camera, count, theme) {
    const { gl } = this;
    if (!count) return;
    this.begin(program, camera);
    ["places", "normals", "colours"].forEach((name, unit_) => {
      gl.activeTexture(gl.TEXTURE0 + unit_);
      gl.bindTexture(gl.TEXTURE_2D, this.textures[name]);
      if (program.at(name)) gl.uniform1i(program.at(name), unit_);
    });
    gl.uniform1i(program.at("rings"), RINGS);
    if (program.at("tendon")) gl.uniform3fv(program.at("tendon"), theme.tendon);
    gl.bindVertexArray(this.tubes.array);
    gl.drawElementsInstanced(gl.TRIANGLES, this.tubes.count, gl.UNSIGNED_SHORT, 0, count);
    gl.bindVertexArray(null);
  }

  /** Draws depths as the sun sees them; gives the sun's matrix. */
  castShadow(stage, show) {
    const { gl, programs } = this;
    const centre = stage.centre();
    const target = [centre[0], centre[1], 0.8];
    const eye = sum(target, times(LIGHT, 6));
    const matrix = matrixProduct(orthographic(1.9, 0.5, 14), lookAt(eye, target, [0, 1, 0]));
    const camera = { matrix, eye };
    gl.bindFramebuffer(gl.FRAMEBUFFER, this.shadow.frame);
    gl.viewport(0, 0, SHADOW, SHADOW);
    gl.clear(gl.DEPTH_BUFFER_BIT);
    this.begin(programs.shapeDepth, camera);
    this.copies(stage, stage.lists.solid);
    this.copies(stage, stage.lists.skin);
    // Muscles lie within the skin, but where there is none.
    if (show.muscles && !show.skin) this.drawTubes(programs.tubeDepth, camera, stage.tubes.count);
    gl.bindFramebuffer(gl.FRAMEBUFFER, null);
    return matrix;
  }

  drawGround(stage, camera, theme, sun) {
    const { gl } = this;
    const { ground } = this.programs;
    this.begin(ground, camera);
    gl.uniform3fv(ground.at("centre"), stage.centre());
    for (const name of ["ground", "line", "sky"]) gl.uniform3fv(ground.at(name), theme[name]);
    gl.uniformMatrix4fv(ground.at("sun"), false, sun);
    gl.activeTexture(gl.TEXTURE0);
    gl.bindTexture(gl.TEXTURE_2D, this.shadow.depth);
    gl.uniform1i(ground.at("shadow"), 0);
    gl.bindVertexArray(this.ground);
    gl.drawArrays(gl.TRIANGLE_STRIP, 0, 4);
    gl.bindVertexArray(null);
  }
}

const SIDES = 6;

/** Rings and angles of one tube. */
function tubeGrid(gl) {
  const points = [];
  const triangles = [];
  for (let ring = 0; ring < RINGS; ring++)
    for (let side = 0; side < SIDES; side++) {
      points.push(ring, (2 * Math.PI * side) / SIDES);
      const [next, up] = [(side + 1) % SIDES, SIDES];
      if (ring + 1 < RINGS) triangles.push(...[[0, side], [0, next], [up, side], [0, next], [up, next], [up, side]].map(([row, s]) => ring * SIDES + row + s));
    }
  const array = gl.createVertexArray();
  gl.bindVertexArray(array);
  gl.bindBuffer(gl.ARRAY_BUFFER, gl.createBuffer());
  gl.bufferData(gl.ARRAY_BUFFER, new Float32Array(points), gl.STATIC_DRAW);
  gl.enableVertexAttribArray(0);
  gl.vertexAttribPointer(0, 2, gl.FLOAT, false, 0, 0);
  gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, gl.createBuffer());
  gl.bufferData(gl.ELEMENT_ARRAY_BUFFER, new Uint16Array(triangles), gl.STATIC_DRAW);
  gl.bindVertexArray(null);
  return { array, count: triangles.length };
}

function dataTexture(gl) {
  const texture = gl.createTexture();
  gl.bindTexture(gl.TEXTURE_2D, texture);
  gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MIN_FILTER, gl.NEAREST);
  gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MAG_FILTER, gl.NEAREST);
  return texture;
}

function upload(gl, texture, width, height, data) {
  if (!height) return;
  gl.bindTexture(gl.TEXTURE_2D, texture);
  gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGBA32F, width, height, 0, gl.RGBA, gl.FLOAT, data);
}

function shadowTarget(gl) {
  const depth = dataTexture(gl);
  gl.texImage2D(gl.TEXTURE_2D, 0, gl.DEPTH_COMPONENT24, SHADOW, SHADOW, 0, gl.DEPTH_COMPONENT, gl.UNSIGNED_INT, null);
  gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_COMPARE_MODE, gl.COMPARE_REF_TO_TEXTURE);
  gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MIN_FILTER, gl.LINEAR);
  gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MAG_FILTER, gl.LINEAR);
  const frame = gl.createFramebuffer();
  gl.bindFramebuffer(gl.FRAMEBUFFER, frame);
  gl.framebufferTexture2D(gl.FRAMEBUFFER, gl.DEPTH_ATTACHMENT, gl.TEXTURE_2D, depth, 0);
  gl.drawBuffers([gl.NONE]);
  gl.bindFramebuffer(gl.FRAMEBUFFER, null);
  return { depth, frame };
}
