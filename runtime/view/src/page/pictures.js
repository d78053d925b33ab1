// Pictures to keep: what is shown, and a film strip of the whole episode.

/** Bodies of a film strip. */
const STRIP = 8;

/** The present picture as PNG. */
function savePicture(viewer) {
  viewer.drawNow();
  element("view").toBlob((blob) => save(blob, `${viewer.shown[0].task}-${viewer.player.time.toFixed(2)}s.png`));
}

/** Pictures at equal times beside each other, each cut around the middle, with its time. */
function saveStrip(viewer) {
  strip(viewer).toBlob((blob) => save(blob, `${viewer.shown[0].task}-strip.png`));
}

function strip(viewer) {
  const view = element("view");
  const [time, height] = [viewer.player.time, view.height];
  const width = Math.min(Math.round(height * 0.55), Math.floor(view.width / viewer.stages.length));
  const film = document.createElement("canvas");
  [film.width, film.height] = [STRIP * width, height];
  const context = film.getContext("2d");
  context.font = `600 ${Math.round(height / 32)}px system-ui, sans-serif`;
  context.fillStyle = inked("ink");
  for (let index = 0; index < STRIP; index++) {
    viewer.player.time = (viewer.player.duration * index) / (STRIP - 1);
    viewer.drawNow();
    context.drawImage(view, (view.width / viewer.stages.length - width) / 2, 0, width, height, index * width, 0, width, height);
    context.fillText(`${viewer.player.time.toFixed(2)} s`, index * width + 0.03 * height, height - 0.04 * height);
  }
  viewer.player.seek(time);
  return film;
}

function save(blob, name) {
  const link = document.createElement("a");
  [link.href, link.download] = [URL.createObjectURL(blob), name];
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 1000);
}
