// A camera that turns about what it looks at, and follows the body.

const VIEWS = { "three-quarter": [-0.65, 0.18], front: [0, 0.05], right: [-Math.PI / 2, 0.05], back: [Math.PI, 0.05], left: [Math.PI / 2, 0.05], above: [-Math.PI / 2, 1.5] };

class Camera {
  constructor() {
    this.follows = true;
    this.pan = [0, 0, 0];
    this.home = [0, 0];
    this.view("three-quarter");
    this.distance = 3.7;
  }

  view(name) {
    [this.yaw, this.pitch] = VIEWS[name];
    this.pan = [0, 0, 0];
    this.distance = 3.7;
  }

  turn(right, up) {
    this.yaw -= right;
    this.pitch = Math.min(1.55, Math.max(-0.4, this.pitch + up));
  }

  zoom(factor) {
    this.distance = Math.min(25, Math.max(0.4, this.distance * factor));
  }

  move(right, up) {
    const side = [-Math.sin(this.yaw), Math.cos(this.yaw), 0];
    const scale = this.distance * 0.8;
    this.pan = sum(this.pan, sum(times(side, -right * scale), [0, 0, up * scale]));
  }

  /** Matrix and eye for a stage in a picture of that aspect. */
  of(stage, aspect) {
    const centre = this.follows ? stage.centre() : this.home;
    const target = sum([centre[0], centre[1], 0.92], this.pan);
    const level = Math.cos(this.pitch);
    const back = [level * Math.cos(this.yaw), level * Math.sin(this.yaw), Math.sin(this.pitch)];
    // In a narrow picture the body shall fit as well.
    const eye = sum(target, times(back, this.distance * Math.max(1, 0.72 / aspect)));
    if (eye[2] < 0.05) eye[2] = 0.05;
    const up = this.pitch > 1.45 ? [-Math.cos(this.yaw), -Math.sin(this.yaw), 0] : [0, 0, 1];
    return { matrix: matrixProduct(perspective(0.55, aspect, 0.05, 80), lookAt(eye, target, up)), eye };
  }

  /** Lets a pointer turn, move and zoom; `changed` is called after each. */
  listen(canvas, changed, clicked) {
    const pointers = new Map();
    let moved = 0;
    canvas.addEventListener("pointerdown", (event) => {
      canvas.setPointerCapture(event.pointerId);
      pointers.set(event.pointerId, event);
      moved = 0;
    });
    canvas.addEventListener("pointermove", (event) => {
      const before = pointers.get(event.pointerId);
      if (!before) return;
      const [dx, dy] = [event.clientX - before.clientX, event.clientY - before.clientY];
      moved += Math.abs(dx) + Math.abs(dy);
      if (pointers.size === 2) {
        const other = [...pointers.values()].find((pointer) => pointer.pointerId !== event.pointerId);
        const apart = (pointer) => Math.hypot(pointer.clientX - other.clientX, pointer.clientY - other.clientY);
        this.zoom(apart(before) / Math.max(1, apart(event)));
        this.move(dx / canvas.clientHeight / 2, dy / canvas.clientHeight / 2);
      } else if (event.shiftKey || event.buttons & 6) this.move(dx / canvas.clientHeight, dy / canvas.clientHeight);
      else this.turn(dx * 0.008, dy * 0.006);
      pointers.set(event.pointerId, event);
      changed();
    });
    const release = (event) => {
      if (pointers.delete(event.pointerId) && event.type === "pointerup" && moved < 5) clicked(event);
    };
    canvas.addEventListener("pointerup", release);
    canvas.addEventListener("pointercancel", release);
    canvas.addEventListener("contextmenu", (event) => event.preventDefault());
    canvas.addEventListener("wheel", (event) => {
      event.preventDefault();
      this.zoom(Math.exp(event.deltaY * 0.0012));
      changed();
    }, { passive: false });
  }
}
