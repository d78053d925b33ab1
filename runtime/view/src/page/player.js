// The clock of all recordings on the page.

class Player {
  /** `changed(time)` is called whenever the time is another. */
  constructor(changed) {
    this.changed = changed;
    this.time = 0;
    this.duration = 0;
    this.speed = 1;
    this.playing = false;
    this.frames = [0];
  }

  /** Sets length and the times of the frames through which one steps. */
  load(duration, frames) {
    this.duration = duration;
    this.frames = frames;
    this.seek(Math.min(this.time, duration));
  }

  seek(time) {
    this.time = Math.min(this.duration, Math.max(0, time));
    this.changed(this.time);
  }

  /** Goes some frames on. */
  step(count) {
    this.pause();
    const { frame, share } = momentAt({ times: this.frames, frames: this.frames.length }, this.time);
    const from = count < 0 && share > 1e-6 ? frame + 1 : frame;
    this.seek(this.frames[Math.min(this.frames.length - 1, Math.max(0, from + count))]);
  }

  toggle() {
    if (this.playing) this.pause();
    else this.play();
  }

  play() {
    if (this.playing || !this.duration) return;
    if (this.time >= this.duration - 1e-9) this.time = 0;
    this.playing = true;
    let before = performance.now();
    const tick = (now) => {
      if (!this.playing) return;
      const passed = Math.min(0.25, (now - before) / 1000);
      before = now;
      this.seek(this.time + passed * this.speed);
      if (this.time >= this.duration) this.pause();
      else requestAnimationFrame(tick);
    };
    requestAnimationFrame(tick);
    this.changed(this.time);
  }

  pause() {
    if (!this.playing) return;
    this.playing = false;
    this.changed(this.time);
  }
}
