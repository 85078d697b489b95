// Small pieces used all over: buttons that ask twice, bars, chips, switches.

import type { ComponentChildren } from 'preact';
import { useEffect, useState } from 'preact/hooks';

import { percent } from '../lib/format.ts';

export function Chip(props: { readonly kind: string; readonly children: ComponentChildren }) {
  return <span class={`chip chip-${props.kind}`}>{props.children}</span>;
}

export function Bar(props: { readonly fraction: number; readonly label: string; readonly kind?: string }) {
  const now = Math.round(Math.min(1, Math.max(0, props.fraction)) * 100);
  return (
    <div
      class={`bar ${props.kind ?? ''}`}
      role="progressbar"
      aria-label={props.label}
      aria-valuemin={0}
      aria-valuemax={100}
      aria-valuenow={now}
      aria-valuetext={percent(props.fraction)}
    >
      <div class="bar-fill" style={{ transform: `scaleX(${now / 100})` }} />
    </div>
  );
}

const kAskForMs = 4000;

// A button that must be pressed twice within a few seconds.
export function AskButton(props: {
  readonly label: string;
  readonly question: string;
  readonly class: string;
  readonly onConfirm: () => void;
}) {
  const [asking, setAsking] = useState(false);
  useEffect(() => {
    if (!asking) return undefined;
    const timer = setTimeout(() => setAsking(false), kAskForMs);
    return () => clearTimeout(timer);
  }, [asking]);
  const press = (): void => {
    setAsking(!asking);
    if (asking) props.onConfirm();
  };
  return (
    <button type="button" class={`${props.class} ${asking ? 'asking' : ''}`} onClick={press}>
      <span aria-live="polite">{asking ? props.question : props.label}</span>
    </button>
  );
}

export interface Choice<T> {
  readonly value: T;
  readonly label: string;
  readonly class?: string;
}

// A row of choices of which one is on.
export function Segmented<T extends string | number>(props: {
  readonly label: string;
  readonly choices: readonly Choice<T>[];
  readonly value: T;
  readonly onChange: (value: T) => void;
}) {
  return (
    <div class="segmented" role="group" aria-label={props.label}>
      {props.choices.map((choice) => (
        <button
          key={choice.value}
          type="button"
          class={choice.class ?? ''}
          aria-pressed={choice.value === props.value}
          onClick={() => props.onChange(choice.value)}
        >
          {choice.label}
        </button>
      ))}
    </div>
  );
}

// A titled part of a page.
export function Panel(props: {
  readonly title: string;
  readonly class?: string;
  readonly aside?: ComponentChildren;
  readonly children: ComponentChildren;
}) {
  return (
    <section class={`panel ${props.class ?? ''}`} aria-label={props.title}>
      <header class="panel-head">
        <h2>{props.title}</h2>
        {props.aside}
      </header>
      {props.children}
    </section>
  );
}
