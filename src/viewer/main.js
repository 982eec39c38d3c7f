// SPDX-License-Identifier: GPL-3.0-or-later
// Puts the parts together: what is chosen lights up in both.

let chosen = null;  // {cell} or {footprint}

const orbit = new Orbit(byId("scene"), {
  changed: () => scene.draw(),
  clicked: (x, y) => {
    const footprint = scene.pick(x, y);
    choose(footprint === null ? null : { footprint });
  },
});
const scene = new Scene(byId("scene"), orbit);
const isCompared = arrays.candidateEnergy.length > 0;
/// The picture, and with a candidate its and the difference: what is done to one is done to all.
const pictures = [["picture"], ...(isCompared ? [["candidate-picture", candidateColour], ["difference-picture", differenceColour, drawRatioLegend]] : [])]
  .map(([name, colourOf, legend], k) => new Picture(byId(name), {
    colourOf, legend,
    clicked: (cell) => choose(cell < 0 ? null : { cell }),
    moved(window_) {
      for (const other of pictures.filter((_, n) => n !== k)) {
        other.window = window_;
        other.draw();
      }
    },
  }));
const [picture] = pictures;
function lightPictures(cells, chosen) { for (const one of pictures) one.light(cells, chosen); }
function drawPictures() { for (const one of pictures) one.draw(); }
function layOut(name) { for (const one of pictures) one.layOut(name); }
const panel = new Panel(byId("chosen"), (what) => { choose(what); reveal(); });

/// The transmitter's tube, and the receiver's where that is apart.
const tubesOf = (f) => facts.receiverApart ? [arrays.drawnTube[f], arrays.drawnReceiveTube[f]] : [arrays.drawnTube[f]];

function choose(what) {
  chosen = what;
  if (!what) {
    scene.light([]);
    lightPictures([], null);
    panel.showNothing();
  } else if (what.cell !== undefined) {
    showPing(placeOf(what.cell).ping);
    const parts = links.ofCell(what.cell);
    scene.light(parts.map((p) => p.footprint), parts.length ? tubesOf(parts[0].footprint) : []);
    lightPictures([what.cell], what.cell);
    panel.showCell(what.cell, parts);
  } else {
    showPing(arrays.ping[what.footprint]);
    const parts = links.ofFootprint(what.footprint);
    scene.light([what.footprint], tubesOf(what.footprint));
    lightPictures(parts.map((p) => p.cell), null);
    panel.showFootprint(what.footprint, parts);
  }
  byId("frame-lit").disabled = !scene.lit.size;
}

/// Of pictures of one ping each that one; of the others one line, or all of them.
const pings = new Pings({
  show(ping) {
    if (chosen && ping !== null && pingOfChosen() !== ping) choose(null);
    for (const one of pictures) one[facts.layout === "fan" ? "ping" : "line"] = ping;
    scene.pings = ping === null ? [0, facts.pings.length] : [ping, ping + 1];
    drawPictures();
    scene.draw();
  },
});
const pingOfChosen = () => chosen.cell !== undefined ? placeOf(chosen.cell).ping : arrays.ping[chosen.footprint];
function showPing(ping) {
  if (pings.all || pings.now === ping) return;
  pings.stop();
  pings.go(ping);
}

function reveal() {
  const lit = [...scene.lit];
  if (!lit.length) return;
  const place = scene.onCanvas(ballOf(cornersOf(lit)).middle), { clientWidth, clientHeight } = scene.canvas;
  if (!place || place[0] < 0 || place[1] < 0 || place[0] > clientWidth || place[1] > clientHeight) frameLit();
}
function frameLit() {
  if (!scene.lit.size) return;
  orbit.frame(cornersOf([...scene.lit]), 3);
}
const shownPoints = () => {
  const [first, end] = scene.pings.map((p) => shapes.corner[shapes.piece[firstFootprint[p]]]);
  return arrays.shapePoints.subarray(3 * first, 3 * end);
};
function frameAll() { orbit.frame(shownPoints()); }
/// From above and behind the sonar, looking at its footprints.
function fromSonar() {
  const { middle } = ballOf(shownPoints()), sonar = facts.pings[scene.pings[0]].sensor, way = minus(middle, sonar);
  orbit.azimuth = facts.layout === "fan" && !facts.acrossTrack ? Math.atan2(-way[0], way[1]) : trackAzimuth() + 0.5;
  orbit.elevation = 0.75;
  frameAll();
}
function trackAzimuth() {
  const along = minus(facts.pings[facts.pings.length - 1].sensor, facts.pings[0].sensor);
  return Math.hypot(along[0], along[1]) > 0 ? Math.atan2(-along[0], along[1]) : 0;
}
function fromAbove() {
  orbit.elevation = Math.PI / 2;
  orbit.azimuth = 0;
  frameAll();
}

function showScale() {
  const scale = scales[byId("colour-by").value]();
  scene.colour(scale);
  const colours = scale.used ? scale.table.slice(0, scale.used) : scale.table.filter((_, k) => k % 15 === 0);
  const hard = colours.flatMap((c, k) => [`${rgb(c)} ${100 * k / colours.length}%`, `${rgb(c)} ${100 * (k + 1) / colours.length}%`]);
  const swatch = (colour, text) => element("span", {}, element("i", { style: `background:${colour}` }), text);
  byId("legend").replaceChildren(element("div", { text: scale.title }),
    element("div", { className: "bar", style: `background:linear-gradient(to right, ${(scale.used ? hard : colours.map(rgb)).join(",")})` }),
    element("div", { className: "ticks" }, ...scale.ticks.map((text) => element("span", { text }))),
    element("div", { className: "swatches" }, swatch(rgb(highlight), "selected"), swatch("var(--shadow)", "shadow"), swatch("var(--mesh)", "outside the tubes"),
      ...(arrays.surfaces.length ? [swatch("var(--beyond)", "no surface (in the picture)")] : [])));
}

byId("title").textContent = facts.title || "Footprints";
byId("subtitle").textContent = `${facts.sensor} (${facts.kind}), ${footprintCount} footprints, ` +
  (facts.pings.length > 1 ? `pings ${facts.pings[0].number} to ${facts.pings[facts.pings.length - 1].number}` : `ping ${facts.pings[0].number}`);
byId("notes-text").replaceChildren(...[...facts.notes,
  `Each footprint is the part of one facet that one tube${facts.receiverApart ? " of each end" : ""} sees first. Energies are for a source of 1 J/sr at 1 m and have a relative precision of 1e-5 in this page.`,
  `Made by tubefoot ${facts.version} from ${facts.source}; scene hash ${facts.sceneHash.slice(0, 16)}.`]
  .map((text) => element("p", { text })));
byId("notes").open = false;

for (const what of ["footprints", "shadows", "mesh", "tubes"])
  byId(`show-${what}`).addEventListener("change", (e) => { scene.shown[what] = e.target.checked; scene.draw(); });
byId("colour-by").addEventListener("change", showScale);
byId("frame-lit").addEventListener("click", frameLit);
byId("frame-all").addEventListener("click", frameAll);
byId("from-above").addEventListener("click", fromAbove);
byId("from-sonar").addEventListener("click", fromSonar);
byId("stripes").textContent = facts.stripes;
byId("stripes").hidden = !facts.stripes;
byId("layout-label").hidden = facts.layout !== "fan";
byId("layout").addEventListener("change", (e) => layOut(e.target.value));
byId("tubes-label").hidden = !arrays.tubeOwner.length;
byId("show-tubes").checked = scene.shown.tubes = facts.pings.length === 1;
if (facts.layout === "fan") scene.pings = [0, 1];

byId("scene").addEventListener("keydown", (e) => {
  const step = { n: 1, N: 1, p: -1, P: -1 }[e.key];
  if (step && footprintCount) {
    const now = chosen && chosen.footprint !== undefined ? chosen.footprint : chosen && scene.lit.size ? [...scene.lit][0] - step : -1;
    choose({ footprint: Math.min(Math.max(now + step, 0), footprintCount - 1) });
  } else if (e.key === "f" || e.key === "F") frameLit();
  else if (e.key === "Home") frameAll();
});
/// Arrow keys go along the picture's own axes.
byId("picture").addEventListener("keydown", (e) => {
  const arrow = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] }[e.key];
  if (e.key === "+" || e.key === "=") picture.zoom(0.8);
  else if (e.key === "-") picture.zoom(1.25);
  else if (e.key === "Home") picture.showAll();
  else if (arrow) choose({ cell: neighbour(arrow) });
  else return;
  e.preventDefault();
});
function neighbour([right, up]) {
  if (!chosen) return cellOf(pings.now, facts.beams >> 1, facts.samples >> 1);
  let { ping, beam, sample } = placeOf(chosen.cell ?? picture.lit[0] ?? 0);
  const within = (v, n) => Math.min(Math.max(v, 0), n - 1);
  if (facts.layout === "fan") {
    beam = within(beam + right, facts.beams);
    sample = within(sample + (facts.acrossTrack && byId("layout").value === "fan" ? -up : up), facts.samples);
  } else if (facts.layout === "echogram") {
    ping = within(ping + right, facts.pings.length);
    sample = within(sample - up, facts.samples);
  } else {
    ping = within(ping + up, facts.pings.length);
    const at = (beam === 0 ? -1 - sample : sample) + right;  // port to the left
    beam = at < 0 ? 0 : 1;
    sample = within(at < 0 ? -1 - at : at, facts.samples);
  }
  return cellOf(ping, beam, sample);
}
document.addEventListener("keydown", (e) => { if (e.key === "Escape") choose(null); });

new ResizeObserver(() => { scene.draw(); drawPictures(); }).observe(document.querySelector("main"));
matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => { scene.draw(); drawPictures(); });

for (const pane of document.querySelectorAll(".beside")) pane.hidden = !isCompared;
document.querySelector("main").classList.toggle("compared", isCompared);
byId("reference-title").hidden = !isCompared;
byId("reference-title").textContent = `Reference: ${facts.reference}`;
byId("candidate-title").textContent = `Candidate: ${facts.candidate}`;
byId("no-webgl").hidden = Boolean(scene.gl);
orbit.whole = ballOf(arrays.shapePoints).radius;
layOut(facts.layout === "fan" ? "fan" : facts.layout);
showScale();
choose(null);
fromSonar();

/// For scripts that drive the page, such as its tests (docs/footprints.md).
window.tubefootView = {
  facts, arrays, choose, cellOf, placeOf, pings, isBeyond,
  get shownPings() { return scene.pings; },
  get labels() { return picture.labels; },
  get lit() { return { footprints: [...scene.lit], cells: [...picture.lit] }; },
  pick: (x, y) => scene.pick(x, y),
  frameLit, frameAll, fromAbove,
  footprintOnCanvas: (f) => scene.onCanvas([...arrays.centroid.subarray(3 * f, 3 * f + 3)]),
  cellOnCanvas: (cell, number = 0) => pictures[number].onCanvas(cell),
  cellAt: (x, y, number = 0) => pictures[number].cellAt(x, y),
  ratioDb: (cell) => isCompared ? ratioDb(arrays.cellEnergy[cell], arrays.candidateEnergy[cell]) : null, ratioRangeDb,
};
