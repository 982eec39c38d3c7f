// SPDX-License-Identifier: GPL-3.0-or-later
// Which footprints made a cell of the picture, and which cells a footprint made.

const links = (() => {
  const { linkFirst, linkCell, linkEnergy } = arrays;
  const footprintOfLink = new Uint32Array(linkCell.length);
  for (let f = 0; f < footprintCount; ++f) footprintOfLink.fill(f, linkFirst[f], linkFirst[f + 1]);
  // The same links by cell: counted, then dealt out.
  const cellFirst = new Uint32Array(arrays.cellEnergy.length + 1);
  for (const cell of linkCell) ++cellFirst[cell + 1];
  for (let c = 0; c + 1 < cellFirst.length; ++c) cellFirst[c + 1] += cellFirst[c];
  const next = cellFirst.slice(0, -1), byCell = new Uint32Array(linkCell.length);
  for (let link = 0; link < linkCell.length; ++link) byCell[next[linkCell[link]]++] = link;

  const strongestFirst = (list) => list.sort((a, b) => b.energy - a.energy);
  return {
    ofCell(cell) {
      return strongestFirst(Array.from(byCell.subarray(cellFirst[cell], cellFirst[cell + 1]),
        (link) => ({ footprint: footprintOfLink[link], energy: linkEnergy[link] })));
    },
    ofFootprint(footprint) {
      const list = [];
      for (let link = linkFirst[footprint]; link < linkFirst[footprint + 1]; ++link)
        list.push({ cell: linkCell[link], energy: linkEnergy[link] });
      return strongestFirst(list);
    },
  };
})();
