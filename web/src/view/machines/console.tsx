// The machine's last words, and a line to it.

import { useEffect, useRef, useState } from 'preact/hooks';

import { commandDevice } from '../../api/client.ts';
import type { Device } from '../../api/types.ts';
import { t } from '../../messages/messages.ts';
import { attempt } from '../../state/store.ts';

export function Console(props: { readonly device: Device }) {
  const { device } = props;
  const [line, setLine] = useState('');
  const [past, setPast] = useState<readonly string[]>([]);
  const [back, setBack] = useState(0);
  const output = useRef<HTMLPreElement>(null);
  useEffect(() => output.current?.scrollTo({ top: output.current.scrollHeight }), [device.console]);
  const can = device.actions.includes('console');
  const send = async (): Promise<void> => {
    const said = line.trim();
    if (said === '' || !can) return;
    setPast((lines) => [...lines.slice(-49), said]);
    setBack(0);
    if (await attempt(() => commandDevice(device.id, 'console', { line: said }))) setLine('');
  };
  const recallLine = (by: number): void => {
    const next = Math.min(past.length, Math.max(0, back + by));
    setBack(next);
    setLine(next === 0 ? '' : (past[past.length - next] ?? ''));
  };
  return (
    <details class="console">
      <summary>{t.machines.console}</summary>
      <pre ref={output} tabIndex={0} aria-label={t.machines.console} role="log">
        {device.console.length === 0 ? t.machines.consoleEmpty : device.console.join('\n')}
      </pre>
      <form
        class="console-line"
        onSubmit={(event) => {
          event.preventDefault();
          void send();
        }}
      >
        <input
          type="text"
          aria-label={t.machines.consoleLine}
          placeholder={t.machines.consoleLine}
          value={line}
          disabled={!can}
          autocomplete="off"
          autocapitalize="characters"
          spellcheck={false}
          onInput={(event) => setLine(event.currentTarget.value)}
          onKeyDown={(event) => {
            if (event.key === 'ArrowUp') recallLine(1);
            else if (event.key === 'ArrowDown') recallLine(-1);
            else return;
            event.preventDefault();
          }}
        />
        <button type="submit" class="button" disabled={!can}>
          {t.machines.send}
        </button>
      </form>
    </details>
  );
}
