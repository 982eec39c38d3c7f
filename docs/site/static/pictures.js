// SPDX-License-Identifier: GPL-3.0-or-later
// A picture that is clicked fills the window. Escape and another click close it, arrows go on. Without this script
// the link around a picture shows it alone.
"use strict";
document.addEventListener("DOMContentLoaded", () => {
  const pictures = [...document.querySelectorAll("article img")].filter((picture) => !picture.closest("button"));
  if (pictures.length === 0) return;
  const view = document.createElement("dialog");
  view.className = "picture";
  view.setAttribute("aria-label", "Picture");
  const large = view.appendChild(document.createElement("img"));
  const words = view.appendChild(document.createElement("p"));
  document.body.append(view);
  let at = 0;
  const show = (k) => {
    at = (k + pictures.length) % pictures.length;
    large.src = pictures[at].src;
    large.alt = pictures[at].alt;
    words.textContent = pictures[at].alt;
  };
  pictures.forEach((picture, k) => {
    picture.classList.add("opens");
    if (!picture.closest("a")) picture.tabIndex = 0;
    const open = (event) => {
      if (event.ctrlKey || event.metaKey || event.shiftKey) return;
      event.preventDefault();
      show(k);
      view.showModal();
    };
    (picture.closest("a") ?? picture).addEventListener("click", open);
    picture.addEventListener("keydown", (event) => event.key === "Enter" && open(event));
  });
  view.addEventListener("click", () => view.close());
  view.addEventListener("keydown", (event) => {
    if (event.key === "ArrowRight") show(at + 1);
    if (event.key === "ArrowLeft") show(at - 1);
  });
});
