// The rest of a cut that ended early: how far the beam got, and what somebody has to have seen before the
// remainder may be queued. It fires only at its own start.

import { useState } from 'preact/hooks';

import { finishCut } from '../api/client.ts';
import type { Beam, Cut } from '../api/types.ts';
import { count, figure } from '../lib/format.ts';
import { t } from '../messages/messages.ts';
import { attempt, receive } from '../state/store.ts';
import { numberOf, TextField, Tick } from './fields.tsx';

function howFar(beam: Beam): string {
  const { finish } = t.cut;
  const share = figure(beam.percent, 3);
  const range = `${figure(beam.leastMm, 5)}–${figure(beam.mostMm, 5)}`;
  return beam.certain ? finish.certain(share, count(beam.line)) : finish.unsure(share, range);
}

export function FinishForm(props: { readonly cut: Cut }) {
  const { cut } = props;
  const { beam } = cut;
  const words = t.cut.finish;
  const [inPlace, setInPlace] = useState(false);
  const [homed, setHomed] = useState(false);
  const [seen, setSeen] = useState('');
  const [busy, setBusy] = useState(false);
  const mustHome = beam?.positionKept !== true;
  const mustSay = beam?.certain !== true; // Where the daemon isn't sure, eyes are.
  const burnt = numberOf(seen);
  const can = inPlace && (homed || !mustHome) && (seen.trim() === '' ? !mustSay : burnt !== null && burnt >= 0);
  const finish = async (): Promise<void> => {
    setBusy(true);
    await attempt(async () => {
      const rest = await finishCut(cut.id, { homed, burntMm: burnt });
      receive({ type: 'cut', seq: null, cut: rest });
    });
    setBusy(false);
  };
  return (
    <form
      class="clear-bed finish"
      aria-label={words.title}
      onSubmit={(event) => {
        event.preventDefault();
        if (can) void finish();
      }}
    >
      <div class="clear-bed-words">
        <h2>{words.title}</h2>
        <p>{beam === null ? words.unknown : howFar(beam)}</p>
        <Tick checked={inPlace} onChange={setInPlace}>
          {words.inPlace}
        </Tick>
        {mustHome && (
          <Tick checked={homed} onChange={setHomed}>
            {words.homed}
          </Tick>
        )}
        {mustSay && (
          <TextField label={words.seen} value={seen} onInput={setSeen} unit="mm" decimal bad={seen.trim() !== '' && burnt === null} />
        )}
      </div>
      <div class="clear-bed-act">
        <button type="submit" class="button primary" disabled={!can || busy}>
          {words.act}
        </button>
        <p class="quiet">{words.hint}</p>
      </div>
    </form>
  );
}
