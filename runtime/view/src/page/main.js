// Starts the viewer. The address may say how: `#t=1.5&view=front&theme=dark&colour=force&play=0`.

async function start() {
  const recordings = await unpack(element("recording").textContent);
  element("message").textContent = "";
  const viewer = new Viewer(recordings);
  window.viewer = viewer;
  const wanted = new URLSearchParams(location.hash.slice(1));
  if (wanted.has("theme")) viewer.setTheme(wanted.get("theme") === "dark" ? "dark" : "light");
  if (wanted.has("view")) viewer.view(Math.max(0, Object.keys(VIEWS).indexOf(wanted.get("view"))));
  if (COLOURINGS.includes(wanted.get("colour"))) viewer.colourBy(wanted.get("colour"));
  if (wanted.has("muscle")) viewer.choose(recordings[0].anatomy.muscles.findIndex(({ name }) => name === wanted.get("muscle")));
  if (wanted.has("beside")) viewer.select(0, Number(wanted.get("beside")));
  if (wanted.has("only")) document.body.classList.add("only");
  viewer.panels.redraw();
  viewer.player.seek(Number(wanted.get("t")) || 0);
  const calm = window.matchMedia("(prefers-reduced-motion: reduce)").matches;
  if (!calm && wanted.get("play") !== "0" && !wanted.has("t")) viewer.player.play();
}

start().catch((problem) => {
  element("message").textContent = `This recording cannot be shown: ${problem.message}`;
  console.error(problem);
});
