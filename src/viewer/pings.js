// SPDX-License-Identifier: GPL-3.0-or-later
// Which ping is shown: a slider, buttons and keys, and playing through them.

/// A ping after another at the pace of the survey, but not faster than can be seen, nor too slow to wait for.
const shortestStep = 100, longestStep = 1000;  // milliseconds

class Pings {
  /// `show(ping)`: null is all at once, where a picture has all of them.
  constructor({ show }) {
    const count = facts.pings.length;
    Object.assign(this, { show, now: 0, all: facts.layout !== "fan", timer: 0 });
    byId("pings").hidden = count < 2;
    byId("all-pings-label").hidden = facts.layout === "fan";
    byId("all-pings").checked = this.all;
    Object.assign(byId("ping"), { max: String(count - 1), value: "0" });
    byId("ping").addEventListener("input", (e) => {
      const ping = Number(e.target.value);  // before stop() says where it was
      this.stop();
      this.go(ping);
    });
    byId("ping-back").addEventListener("click", () => { this.stop(); this.step(-1); });
    byId("ping-on").addEventListener("click", () => { this.stop(); this.step(1); });
    byId("ping-play").addEventListener("click", () => this.toggle());
    byId("all-pings").addEventListener("change", (e) => {
      const all = e.target.checked;
      this.stop();
      if (all) this.goAll(); else this.go(this.now);
    });
    document.addEventListener("keydown", (e) => {
      const press = { ",": () => this.step(-1), ".": () => this.step(1), " ": () => this.toggle() }[e.key];
      if (!press || count < 2 || e.ctrlKey || e.metaKey || e.altKey || /^(BUTTON|SELECT|SUMMARY)$/.test(e.target.tagName) ||
        (e.key === " " && e.target.type === "checkbox")) return;
      if (e.key !== " ") this.stop();
      press();
      e.preventDefault();
    });
    this.say();
  }
  get playing() { return this.timer !== 0; }

  go(ping) {
    this.now = Math.min(Math.max(ping, 0), facts.pings.length - 1);
    this.all = false;
    this.show(this.now);
    this.say();
  }
  goAll() {
    this.all = true;
    this.show(null);
    this.say();
  }
  step(by) { this.go((this.now + by + facts.pings.length) % facts.pings.length); }

  toggle() {
    if (this.playing) this.stop(); else this.play();
  }
  play() {
    const wait = () => {
      const next = facts.pings[this.now + 1], seconds = next ? next.time - facts.pings[this.now].time : 1;
      return Math.min(Math.max(1000 * seconds, shortestStep), longestStep);
    };
    const on = () => {
      this.step(1);
      this.timer = setTimeout(on, wait());
    };
    if (this.all) this.go(this.now);
    this.timer = setTimeout(on, wait());
    this.say();
  }
  stop() {
    clearTimeout(this.timer);
    this.timer = 0;
    this.say();
  }

  say() {
    const { number, time } = facts.pings[this.now];
    byId("ping").value = String(this.now);
    byId("ping").setAttribute("aria-valuetext", `ping ${number}`);
    byId("ping-text").textContent = this.all ? `all ${facts.pings.length} pings` : `ping ${number}, ${time.toFixed(2)} s`;
    byId("ping-play").textContent = this.playing ? "Pause" : "Play";
    byId("all-pings").checked = this.all;
  }
}
