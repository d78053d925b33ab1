// The keyboard: everything that the pointer can do.

/** Keys with what they do: [key, words, action of the viewer]. */
const KEYS = [
  [" ", "Space", "Play, pause", (viewer) => viewer.player.toggle()],
  ["ArrowRight", "→", "One frame on; with Shift half a second", (viewer, event) => (event.shiftKey ? viewer.player.seek(viewer.player.time + 0.5) : viewer.player.step(1))],
  ["ArrowLeft", "←", "One frame back; with Shift half a second", (viewer, event) => (event.shiftKey ? viewer.player.seek(viewer.player.time - 0.5) : viewer.player.step(-1))],
  ["Home", "Home", "To the beginning", (viewer) => viewer.player.seek(0)],
  ["End", "End", "To the end", (viewer) => viewer.player.seek(viewer.player.duration)],
  ["[", "[", "Slower", (viewer) => viewer.pace(-1)],
  ["]", "]", "Faster", (viewer) => viewer.pace(1)],
  ["a", "A", "Turn to the left", (viewer) => viewer.turn(-0.12, 0)],
  ["d", "D", "Turn to the right", (viewer) => viewer.turn(0.12, 0)],
  ["w", "W", "Turn up", (viewer) => viewer.turn(0, 0.1)],
  ["s", "S", "Turn down", (viewer) => viewer.turn(0, -0.1)],
  ["+", "+", "Nearer", (viewer) => viewer.zoom(0.85)],
  ["-", "−", "Farther", (viewer) => viewer.zoom(1 / 0.85)],
  ["1", "1 … 6", "Views: three-quarter, front, right, back, left, above", (viewer) => viewer.view(0)],
  ["2", "", "", (viewer) => viewer.view(1)],
  ["3", "", "", (viewer) => viewer.view(2)],
  ["4", "", "", (viewer) => viewer.view(3)],
  ["5", "", "", (viewer) => viewer.view(4)],
  ["6", "", "", (viewer) => viewer.view(5)],
  ["f", "F", "Follow the body, or stay", (viewer) => viewer.layer("follow")],
  ["m", "M", "Muscles", (viewer) => viewer.layer("muscles")],
  ["b", "B", "Bones", (viewer) => viewer.layer("bones")],
  ["k", "K", "Skin: glass, solid, none", (viewer) => viewer.layer("skin")],
  ["c", "C", "Contact forces", (viewer) => viewer.layer("contacts")],
  ["r", "R", "Reference motion", (viewer) => viewer.layer("reference")],
  ["g", "G", "What colours muscles", (viewer) => viewer.nextColour()],
  ["n", "N", "Next muscle; with Shift the one before", (viewer, event) => viewer.choose(viewer.chosen + (event.shiftKey ? -1 : 1))],
  ["x", "X", "Next family; with Shift the one before", (viewer, event) => viewer.chooseFamily(viewer.family + (event.shiftKey ? -1 : 1))],
  ["Escape", "Esc", "All muscles again", (viewer) => viewer.clear()],
  ["t", "T", "Light or dark", (viewer) => viewer.nextTheme()],
  ["p", "P", "Save a picture", savePicture],
  ["i", "I", "Save a film strip", saveStrip],
  ["o", "O", "Open a second page beside this one", () => document.getElementById("file").click()],
  ["?", "?", "These keys", (viewer) => viewer.showKeys()],
];

function listenToKeys(viewer) {
  document.addEventListener("keydown", (event) => {
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    const target = event.target;
    // Lists and sliders keep the keys by which they are used; buttons keep the space bar.
    if (target.tagName === "SELECT" || target.closest("dialog")) return;
    const slider = target.tagName === "INPUT" && target.type === "range";
    if (target.tagName === "INPUT" && !slider && event.key === " ") return;
    if (target.tagName === "BUTTON" && event.key === " ") return;
    const wanted = event.key.length === 1 ? event.key.toLowerCase() : event.key;
    const found = KEYS.find(([key]) => key === wanted);
    if (!found) return;
    event.preventDefault();
    found[3](viewer, event);
  });
}

/** Fills the list of keys. */
function writeKeys(dialog) {
  const list = document.createElement("dl");
  for (const [, key, words] of KEYS.filter(([, key]) => key)) {
    const [term, text] = [document.createElement("dt"), document.createElement("dd")];
    term.appendChild(document.createElement("kbd")).textContent = key;
    text.textContent = words;
    list.append(term, text);
  }
  const close = document.createElement("button");
  close.textContent = "Close";
  close.addEventListener("click", () => dialog.close());
  const title = document.createElement("h2");
  title.textContent = "Keys";
  dialog.replaceChildren(title, list, close);
}
