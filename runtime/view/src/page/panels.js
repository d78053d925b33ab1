// The controls and charts around the picture.

class Panels {
  constructor(viewer) {
    this.viewer = viewer;
    const scrub = (time) => {
      viewer.player.pause();
      viewer.player.seek(time);
    };
    const main = () => viewer.shown[0];
    this.terms = new Chart(element("terms"), (context, width, height) => paintTerms(context, width, height, main()), scrub);
    this.map = new Chart(element("families"), (context, width, height) => paintFamilies(context, width, height, main(), this.rows), (time, event) => this.onMap(time, event, scrub));
    this.map.left = FAMILY_LABELS;
    this.curve = new Chart(element("curve"), (context, width, height) => paintSignal(context, width, height, viewer.shown, element("signal").value, this.curve.duration), scrub);
    this.muscleCurve = new Chart(element("muscle-curve"), (context, width, height) => paintMuscle(context, width, height, main(), viewer.chosen), scrub);
    this.rows = [];
    this.buttons();
    writeKeys(element("keys"));
    listenToKeys(viewer);
    viewer.camera.listen(element("view"), () => viewer.refresh(), (event) => viewer.click(event));
    new ResizeObserver(() => viewer.refresh()).observe(element("view"));
  }

  buttons() {
    const { viewer } = this;
    const on = (id, type, action) => element(id).addEventListener(type, action);
    on("play", "click", () => viewer.player.toggle());
    on("back", "click", () => viewer.player.step(-1));
    on("forth", "click", () => viewer.player.step(1));
    on("time", "input", (event) => {
      viewer.player.pause();
      viewer.player.seek(Number(event.target.value));
    });
    on("speed", "change", (event) => (viewer.player.speed = Number(event.target.value)));
    on("camera", "change", (event) => viewer.view(event.target.selectedIndex));
    on("colour", "change", (event) => viewer.colourBy(event.target.value));
    on("signal", "change", () => {
      this.curve.redraw();
      this.at(viewer.player.time);
    });
    on("muscle", "change", (event) => viewer.choose(Number(event.target.value)));
    on("picture", "click", () => savePicture(viewer));
    on("strip", "click", () => saveStrip(viewer));
    on("open", "click", () => element("file").click());
    on("file", "change", (event) => event.target.files[0] && viewer.open(event.target.files[0]));
    on("theme", "click", () => viewer.nextTheme());
    on("help", "click", () => viewer.showKeys());
    for (const [name, words] of LAYERS) {
      const label = element("layers").appendChild(document.createElement("label"));
      const box = label.appendChild(document.createElement("input"));
      [box.type, box.id] = ["checkbox", `show-${name}`];
      label.append(` ${words}`);
      box.addEventListener("change", () => (name === "skin" ? viewer.layer(name) : viewer.layer(name, box.checked)));
    }
  }

  /** Fills everything that depends on the recordings that are shown. */
  load() {
    const { viewer } = this;
    const [first] = viewer.shown;
    const duration = Math.max(...viewer.shown.map((recording) => recording.duration));
    this.legend = termsLegend(element("terms-legend"), first);
    element("terms-section").hidden = !first.terms.length;
    element("families-section").hidden = !isActive(first);
    element("muscle-section").hidden = !first.anatomy.muscles.length;
    this.terms.duration = this.map.duration = this.muscleCurve.duration = first.duration;
    this.curve.duration = duration;
    Object.assign(element("time"), { max: duration });
    fill(element("signal"), signalsOf(first).map(({ name, unit: unit_ }) => [name, unit_ ? `${name} [${unit_}]` : name]));
    if (!first.signals.length) element("signal").value = liveliest(first);
    fill(element("muscle"), [[-1, "none: click one"], ...first.anatomy.muscles.map(({ name }, index) => [index, name])]);
    element("show-reference").parentElement.hidden = !viewer.shown.some((recording) => recording.tracks.reference.length);
    element("show-markers").parentElement.hidden = !viewer.shown.some((recording) => recording.markers.length);
    this.captions();
    this.choices();
    this.controls();
    this.families();
    this.muscle();
    this.redraw();
  }

  captions() {
    element("captions").replaceChildren(
      ...this.viewer.shown.map((recording) => {
        const block = document.createElement("div");
        block.appendChild(document.createElement("h1")).textContent = [recording.label, recording.task, recording.policy].filter(Boolean).join(", ");
        const episode = recording.episode ? `seed ${recording.episode[0]}, episode ${recording.episode[1]}` : "";
        const verdict = recording.success === null ? "" : recording.success ? "success" : "no success";
        const total = recording.total === null ? "" : `return ${short(recording.total)}`;
        for (const line of [[recording.outcome, verdict, total], [episode, recording.condition]])
          block.appendChild(document.createElement("p")).textContent = line.filter(Boolean).join(" · ");
        return block;
      }),
    );
  }

  /** Which recordings are shown, where there are several. */
  choices() {
    const { viewer } = this;
    element("choices").hidden = viewer.recordings.length < 2;
    const options = viewer.recordings.map((recording, index) => [index, [recording.label, recording.task, recording.policy, recording.episode ? recording.episode[1] : ""].filter((word) => word !== "").join(" ")]);
    const list = (name, all, chosen, select) => {
      const label = document.createElement("label");
      const box = document.createElement("select");
      label.append(`${name} `, box);
      fill(box, all);
      box.value = String(chosen);
      box.addEventListener("change", () => select(Number(box.value)));
      return label;
    };
    element("choices").replaceChildren(
      list("Episode", options, viewer.places[0], (place) => viewer.select(place, viewer.places[1])),
      list("beside", [[-1, "none"], ...options], viewer.places[1], (place) => viewer.select(viewer.places[0], place)),
    );
  }

  controls() {
    const { viewer } = this;
    for (const [name] of LAYERS) {
      const box = element(`show-${name}`);
      box.checked = Boolean(viewer.show[name]);
      if (name === "skin") box.indeterminate = viewer.show.skin === 1;
    }
    element("colour").value = viewer.by;
    const [low, high, words] = SCALES[viewer.by];
    [element("scale-low").textContent, element("scale-high").textContent, element("scale-name").textContent] = [low, high, words];
    if (viewer.by !== "capacity" && viewer.shown.some(({ condition }) => condition)) element("scale-name").textContent += "; grey: weak or tired";
    const context = element("scale-bar").getContext("2d");
    for (let x = 0; x < 160; x++) {
      context.fillStyle = css(heat(x / 159));
      context.fillRect(x, 0, 1, 10);
    }
  }

  families() {
    const { viewer } = this;
    this.rows = familyRows(viewer.shown[0].anatomy, viewer.family);
    const name = viewer.family < 0 ? "" : `: ${viewer.shown[0].anatomy.families[viewer.family]}`;
    element("families-section").firstChild.textContent = viewer.family < 0 ? "Activation by muscle family" : `Activation${name}`;
    this.map.redraw();
  }

  /** A label of the map chooses its family or muscle; the map sets the time. */
  onMap(time, event, scrub) {
    const box = element("families").getBoundingClientRect();
    if (event.clientX - box.left > FAMILY_LABELS) scrub(time);
    else if (event.type === "pointerdown") {
      const row = this.rows[Math.floor(((event.clientY - box.top) / box.height) * this.rows.length)];
      const { viewer } = this;
      if (viewer.family < 0 && row) viewer.chooseFamily(row.family);
      else if (row && viewer.chosen !== row.muscles[0]) viewer.choose(row.muscles[0]);
      else viewer.clear();
    }
  }

  muscle() {
    element("muscle").value = String(this.viewer.chosen);
    element("muscle-curve").hidden = this.viewer.chosen < 0;
    if (this.viewer.chosen < 0) element("muscle-facts").replaceChildren();
    this.muscleCurve.redraw();
  }

  redraw() {
    for (const chart of [this.terms, this.map, this.curve, this.muscleCurve]) chart.redraw();
  }

  /** Follows the time. */
  at(time) {
    const { viewer } = this;
    for (const chart of [this.terms, this.map, this.curve, this.muscleCurve]) chart.at(Math.min(time, chart.duration));
    const { frame } = momentAt(viewer.shown[0], time);
    this.legend(frame);
    const signal = signalsOf(viewer.shown[0]).find(({ name }) => name === element("signal").value);
    element("curve-value").textContent = signal ? `${short(valuesOf(viewer.shown[0], signal)[frame])} ${signal.unit}` : "";
    element("time").value = String(time);
    element("time").setAttribute("aria-valuetext", `${time.toFixed(2)} seconds`);
    element("clock").textContent = `${time.toFixed(2)} / ${viewer.player.duration.toFixed(2)} s`;
    element("play").textContent = viewer.player.playing ? "❚❚" : "▶";
    element("play").setAttribute("aria-label", viewer.player.playing ? "Pause" : "Play");
    if (viewer.chosen >= 0 && viewer.stages.length) showFacts(element("muscle-facts"), muscleFacts(viewer.stages[0], viewer.chosen));
  }
}

/** Fills a list with [value, words]. */
function fill(list, options) {
  const before = list.value;
  list.replaceChildren(...options.map(([value, words]) => new Option(words, value)));
  if (options.some(([value]) => String(value) === before)) list.value = before;
}
