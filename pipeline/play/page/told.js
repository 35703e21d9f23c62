// What is told of the model in the hand: force, stiffness, error, effects, and a link to all of it.
'use strict';

class ToldPlayer extends SeenPlayer {
  /// Force, way and stiffness at the hand.
  feel() {
    if (!this.hand) return null;
    if (this.hand.ball) {
      const strength = length3(this.numerics.ballForce()), moved = length3(minus3(this.hand.ball.at, this.hand.from));
      return {strength, moved, stiffness: moved > 0 ? strength / moved : NaN, words: 'force over depth'};
    }
    const {force, place} = this.numerics.at(this.hand.touch), strength = length3(force);
    const C = this.numerics.compliance(this.hand.touch);
    const along = strength > 1e-7 ? unit3(force) : this.hand.normal;
    return {strength, moved: length3(minus3(place, this.hand.from)), stiffness: C ? 1 / along3(C, along) : NaN,
      words: strength > 1e-7 ? 'stiffness along the pull' : 'stiffness across the skin'};
  }
  tell(now) {
    if (!this.hand || now - (this.felt ?? 0) > (this.feelEvery ?? 90)) {
      const begin = performance.now(), feel = this.feel();
      this.felt = now;
      this.feelEvery = Math.max(90, 20 * (performance.now() - begin));  // a twentieth of the time at most
      this.at('force').textContent = inUnit(feel?.strength ?? 0, 'N');
      this.at('moved').textContent = inUnit(feel?.moved ?? 0, 'mm');
      this.at('stiffness').textContent = feel ? inUnit(feel.stiffness, 'N/mm') : '–';
      this.at('along').textContent = feel?.words ?? 'stiffness there';
      this.unspoken = now - (this.spoke ?? 0) <= 1200;  // what is spoken changes no faster than it can be heard
      if (!this.unspoken) {
        this.spoke = now;
        this.at('spoken').textContent = feel ? `Force ${inUnit(feel.strength, 'newton')}, moved ${inUnit(feel.moved,
          'millimetres')}, stiffness ${inUnit(feel.stiffness, 'newton per millimetre')}.` : 'Nothing is held.';
      }
    }
    this.tellActuators();
    const errors = this.markerErrors();
    if (errors) {
      const worst = errors.lengths.reduce((a, b) => (b > a ? b : a), 0);
      this.at('told').textContent = `Off by ${inUnit(errors.rms, 'mm')} rms, ${inUnit(worst, 'mm')} at most` +
        `${this.hand || this.pinned.length ? ', pulled besides' : ''}. Dark: measured; light: the model.`;
    } else if (this.set >= 0) {
      this.at('told').textContent = this.state ? 'Nothing was read in this state.' : 'Choose one: its loads act, and the measured markers are drawn.';
    }
  }
  /// Where each actuator is, and how taut a tendon that is drawn in.
  tellActuators() {
    this.actuators.forEach(({kind, unit}, i) => {
      const tension = kind === 'length' ? `, ${inUnit(this.numerics.tension(i), 'N')}` : '';
      const slider = this.at(`drive-${i}`), told = inUnit(this.driven[i], unit) + tension;
      slider.value = this.asked[i];
      slider.setAttribute('aria-valuetext', told);
      this.at(`driven-${i}`).textContent = told;
    });
  }
  tellChoice() {
    this.at('model').value = this.chosen.model;
    this.at('about').textContent = this.model.about;
    this.at('about').hidden = !this.model.about;
    this.at('probe').value = this.chosen.probe;
    this.at('switches').replaceChildren(...this.model.effects.map((effect) => this.switchOf(effect)));
    this.at('effects').hidden = this.model.effects.length === 0;
    this.at('alone').hidden = this.data.models.length < 2 || this.set < 0;
    this.tellErrors();
    this.changed = true;
    this.tellLink();
  }
  switchOf(effect) {
    const label = document.createElement('label'), box = document.createElement('input');
    label.className = 'switch';
    Object.assign(box, {type: 'checkbox', id: `effect-${effect.name}`, checked: this.isOn(effect), disabled: !effect.played});
    box.setAttribute('role', 'switch');
    box.addEventListener('change', () => {
      this.switchEffect(effect.name, box.checked);
      this.at(`effect-${effect.name}`)?.focus();
    });
    const words = document.createElement('span'), small = document.createElement('small');
    const many = effect.numbers.length > 6;  // a gain for each probe, say
    const numbers = (many ? `${effect.numbers.slice(0, 6).join(', ')}, …` : effect.numbers.join(', ')).replaceAll('^2', '²');
    small.textContent = `${effect.meaning} ${numbers}${effect.played ? '' : '. Not played here'}`;
    words.append(effect.fault ? `${effect.name} (of the measurement)` : effect.name, small);
    label.append(box, words);
    return label;
  }
  /// Bars: the ladder as it was told, and what the model in the hand comes to.
  tellErrors() {
    const shown = this.set >= 0;
    this.at('errors').hidden = this.at('replay').hidden = this.at('markers-label').hidden = !shown;
    if (shown && !this.data.judged) this.at('errors').hidden = !this.data.models.some((m) => m.told);
    this.at('findings-label').hidden = !this.findings.length && !this.data.exchanged.length;
    if (!shown) return;
    const off = this.model.effects.filter((e) => e.played && !this.isOn(e)).map((e) => e.name);
    const {verdict} = this, told = this.data.models.filter((m) => m.told);
    const bars = told.map((m) => ({name: m.name, rms: m.told.rms_mm}));
    const name = `In the hand${off.length ? `, without ${off.join(', ')}` : ''}`;
    if (this.data.judged) bars.push({name, rms: verdict.done ? verdict.rms : NaN, now: true});
    const largest = Math.max(...bars.map((b) => b.rms || 0)) || 1;
    this.at('bars').replaceChildren(...bars.map(({name: text, rms, now}) => {
      const row = document.createElement('div'), words = document.createElement('span');
      const value = document.createElement('b'), bar = document.createElement('i');
      row.className = now ? 'bar now' : 'bar';
      words.textContent = text;
      value.textContent = inUnit(rms, 'mm');
      bar.style.width = `${100 * Math.min(1, (rms || 0) / largest)}%`;
      row.append(words, value, bar);
      return row;
    }));
    if (!this.data.judged) {
      this.at('judged').textContent = 'As the run tells them: under actuators, models in the hand are not judged here.';
      return;
    }
    const part = this.judge.heldOut.size ? 'rms over the probes that were fitted' : 'rms over all measured coordinates';
    const unseen = Number.isFinite(verdict.heldOutRms) ? `; ${inUnit(verdict.heldOutRms, 'mm')} on those held out` : '';
    this.at('judged').textContent = verdict.trouble ? `Not found: ${verdict.trouble}`
      : verdict.whole ? `${part}${unseen}${verdict.lowered ? `; ${verdict.lowered} loads lowered to what it bears` : ''}.`
      : `${verdict.done} of ${verdict.of || '…'} states played.`;
  }

  // --- A link ----------------------------------------------------------------------------------------------------
  link() {
    const {chosen, camera} = this, round = (v) => +v.toPrecision(5), state = this.state;
    const pulled = [...this.pinned, ...(this.hand && !this.hand.ball ? [this.hand.touch] : [])].slice(0, 1).map((t) => this.numerics.at(t))[0];
    return inHash.write({
      model: chosen.model, off: [...chosen.off].join(','), probe: state ? chosen.probe : '',
      colour: this.at('colour').value, radius: this.at('radius').value,
      skeleton: this.at('show-skeleton').checked ? 1 : '',
      driven: this.asked.some((value) => value !== 0) ? this.asked.map(round).join(',') : '',
      view: [...camera.turned, ...camera.target, camera.distance].map(round).join(','),
      pull: pulled ? [...pulled.rest, ...pulled.force, pulled.radius].map(round).join(',') : '',
    });
  }
  tellLink() {
    clearTimeout(this.linking);
    this.linking = setTimeout(() => history.replaceState(null, '', this.link()), 300);
  }
  /// Takes up what a link tells; what it does not tell, or wrongly, stays as it is.
  follow(hash) {
    const told = inHash.read(hash), {chosen, camera} = this;
    const index = (text, count) => (text !== undefined && +text >= 0 && +text < count ? Math.floor(+text) : null);
    chosen.model = index(told.model, this.data.models.length) ?? chosen.model;
    if (told.off !== undefined) chosen.off = new Set(told.off.split(',').filter(Boolean));
    else if (told.model !== undefined) chosen.off = new Set();
    if (this.set >= 0) chosen.probe = index(told.probe, this.data.sets[this.set].states.length) ?? chosen.probe;
    if ([...this.at('colour').options].some((o) => o.value === told.colour)) this.at('colour').value = told.colour;
    if (told.radius !== undefined && +told.radius >= 0) this.at('radius').value = told.radius;
    this.at('show-skeleton').checked = told.skeleton === '1';
    this.asked = inHash.numbers(told.driven, this.actuators.length) ?? this.settings;
    const view = inHash.numbers(told.view, 13), pull = inHash.numbers(told.pull, 7);
    if (view) Object.assign(camera, {turned: view.slice(0, 9), target: view.slice(9, 12), distance: view[12]});
    this.restart(true);
    this.settle();
    if (pull) this.press(pull.slice(0, 3), unit3(pull.slice(3, 6)), pull.slice(3, 6), Math.max(0, pull[6]));
  }
}
