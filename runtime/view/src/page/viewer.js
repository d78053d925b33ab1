// The viewer: recordings, what of them is shown, and everything that changes with the time.

const element = (id) => document.getElementById(id);
/** Layers with their words; skin has three states, the others two. */
const LAYERS = [["muscles", "muscles"], ["bones", "bones"], ["skin", "skin"], ["contacts", "forces"], ["markers", "markers"], ["reference", "reference"], ["follow", "follow"]];
const COLOURINGS = ["activation", "excitation", "force", "fibre", "capacity"];
const SCALES = { activation: ["0", "1", "activation"], excitation: ["0", "1", "excitation"], force: ["0", "1", "force / peak"], fibre: ["0.5", "1.5", "fibre / optimal length"], capacity: ["0", "1", "strength left"] };

class Viewer {
  constructor(recordings) {
    this.recordings = recordings;
    // For tests and for programs around the page.
    this.parts = { pathOf, momentArms, strip };
    this.show = { muscles: true, bones: true, skin: 1, contacts: true, markers: true, reference: true, follow: true };
    [this.chosen, this.family, this.by] = [-1, -1, "activation"];
    this.camera = new Camera();
    this.player = new Player(() => this.refresh());
    this.themeName = window.matchMedia("(prefers-color-scheme: dark)").matches ? "dark" : "light";
    try {
      this.renderer = new Renderer(element("view"));
    } catch (problem) {
      element("message").textContent = problem.message;
    }
    this.panels = new Panels(this);
    this.select(0, -1);
  }

  /** Shows a recording, and beside it another, or none (-1). */
  select(first, second) {
    this.places = [first, second];
    this.shown = [first, second].filter((place) => place >= 0).map((place) => this.recordings[place]);
    this.stages = this.renderer ? this.shown.map((recording) => new Stage(this.renderer.gl, recording)) : [];
    const longest = this.shown.reduce((a, b) => (b.duration > a.duration ? b : a));
    this.chosen = Math.min(this.chosen, this.shown[0].anatomy.muscles.length - 1);
    this.family = Math.min(this.family, this.shown[0].anatomy.families.length - 1);
    this.setTheme(this.themeName);
    // Where nothing is active the length of fibres tells more.
    if (!isActive(this.shown[0]) && this.by === "activation") this.by = "fibre";
    this.panels.load();
    this.player.load(longest.duration, longest.times);
  }

  setTheme(name) {
    this.themeName = name;
    document.documentElement.dataset.theme = name;
    this.theme = THEMES[name];
  }

  nextTheme() {
    this.setTheme(this.themeName === "dark" ? "light" : "dark");
    this.panels.redraw();
    this.refresh();
  }

  /** Draws the present time with the next picture of the display. */
  refresh() {
    if (this.asked) return;
    this.asked = true;
    requestAnimationFrame(() => {
      this.asked = false;
      this.drawNow();
    });
  }

  drawNow() {
    const look = { theme: this.theme, by: this.by, chosen: this.chosen, family: this.family };
    this.stages.forEach((stage) => stage.update(Math.min(this.player.time, stage.recording.duration), this.show, look));
    if (this.renderer) {
      this.renderer.draw(this.stages, (stage, aspect) => this.camera.of(stage, aspect), this.theme, this.show);
      drawLabels(element("labels"), this.stages, this.camera, element("view"));
    }
    this.panels.at(this.player.time);
    if (!document.documentElement.dataset.ready) document.documentElement.dataset.ready = String(Math.round(performance.now()));
  }

  layer(name, value) {
    if (name === "skin") this.show.skin = value ?? (this.show.skin + 1) % 3;
    else this.show[name] = value ?? !this.show[name];
    if (name === "follow") {
      this.camera.home = this.stages[0]?.centre().slice(0, 2) ?? [0, 0];
      this.camera.follows = this.show.follow;
    }
    this.panels.controls();
    this.refresh();
  }

  choose(muscle) {
    const count = this.shown[0].anatomy.muscles.length;
    this.chosen = muscle < -1 ? count - 1 : muscle >= count ? -1 : muscle;
    this.panels.muscle();
    this.refresh();
  }

  chooseFamily(family) {
    const count = this.shown[0].anatomy.families.length;
    this.family = family < -1 ? count - 1 : family >= count ? -1 : family;
    this.panels.families();
    this.refresh();
  }

  clear() {
    this.choose(-1);
    this.chooseFamily(-1);
  }

  /** The muscle under the pointer. */
  click(event) {
    const canvas = element("view");
    const box = canvas.getBoundingClientRect();
    const width = box.width / this.stages.length;
    const index = Math.min(this.stages.length - 1, Math.max(0, Math.floor((event.clientX - box.left) / width)));
    const stage = this.stages[index];
    const at = [(2 * (event.clientX - box.left - index * width)) / width - 1, 1 - (2 * (event.clientY - box.top)) / box.height];
    this.choose(pick(stage, this.camera.of(stage, width / box.height), at, width / box.height, 24 / box.height));
  }

  /** Where the middle of a muscle is in the window, px. */
  screenPlace(name) {
    const [stage] = this.stages;
    const tube = stage.tubes.muscleOf.indexOf(stage.recording.anatomy.muscles.findIndex((muscle) => muscle.name === name));
    const at = 4 * (tube * RINGS + (RINGS >> 1));
    const box = element("view").getBoundingClientRect();
    const width = box.width / this.stages.length;
    const [x, y] = projected(this.camera.of(stage, width / box.height).matrix, stage.tubes.places.subarray(at, at + 3));
    return [box.left + (0.5 + 0.5 * x) * width, box.top + (0.5 - 0.5 * y) * box.height];
  }

  turn(right, up) {
    this.camera.turn(right, up);
    this.refresh();
  }

  zoom(factor) {
    this.camera.zoom(factor);
    this.refresh();
  }

  view(index) {
    this.camera.view(Object.keys(VIEWS)[index]);
    element("camera").selectedIndex = index;
    this.refresh();
  }

  colourBy(name) {
    this.by = name;
    this.panels.controls();
    this.refresh();
  }

  nextColour() {
    this.colourBy(COLOURINGS[(COLOURINGS.indexOf(this.by) + 1) % COLOURINGS.length]);
  }

  pace(change) {
    const list = element("speed");
    list.selectedIndex = Math.min(list.length - 1, Math.max(0, list.selectedIndex + change));
    this.player.speed = Number(list.value);
  }

  showKeys() {
    const dialog = element("keys");
    if (dialog.open) dialog.close();
    else dialog.showModal();
  }

  /** Takes the first recording of another page and shows it beside the present one. */
  async open(file) {
    // A document that is only parsed runs no program.
    const other = new DOMParser().parseFromString(await file.text(), "text/html").getElementById("recording");
    if (!other) {
      element("message").textContent = `${file.name} has no recording: a page of this viewer is needed`;
      return;
    }
    const added = await unpack(other.textContent);
    this.recordings.push(...added);
    element("message").textContent = "";
    this.select(this.places[0], this.recordings.length - added.length);
  }
}

/** Whether any muscle of a recording is ever active. */
const isActive = ({ tracks }) => tracks.activations.some((column) => column.some((code) => code > 0));

/** Names and numbers over the picture. */
function drawLabels(holder, stages, camera, canvas) {
  const wanted = stages.flatMap((stage, index) => stage.labels.map((label) => ({ ...label, stage, index })));
  while (holder.children.length < wanted.length) holder.appendChild(document.createElement("span"));
  const width = canvas.clientWidth / Math.max(1, stages.length);
  [...holder.children].forEach((span, place) => {
    const label = wanted[place];
    span.hidden = true;
    if (!label) return;
    const { matrix } = camera.of(label.stage, width / canvas.clientHeight);
    const [x, y, , before] = projected(matrix, label.at);
    if (!before || Math.abs(x) > 1 || Math.abs(y) > 1) return;
    span.hidden = false;
    span.textContent = label.text;
    span.style.color = css(label.colour);
    span.style.transform = `translate(${(label.index + 0.5 + 0.5 * x) * width + 4}px,${(0.5 - 0.5 * y) * canvas.clientHeight - 8}px)`;
  });
}
