// Line drawings, all on a 24 × 24 grid and in the colour of the text around them.

const kPaths = {
  plus: 'M12 5v14M5 12h14',
  minus: 'M5 12h14',
  fit: 'M4 9V4h5M15 4h5v5M20 15v5h-5M9 20H4v-5',
  close: 'M6 6l12 12M18 6L6 18',
  left: 'M15 5l-7 7 7 7',
  right: 'M9 5l7 7-7 7',
  first: 'M5 4h14M5 19l7-9 7 9',
  up: 'M5 15l7-7 7 7',
  down: 'M5 9l7 7 7-7',
  download: 'M12 4v11M7 11l5 5 5-5M5 20h14',
  upload: 'M12 20V8M7 12l5-5 5 5M5 4h14',
  home: 'M4 11l8-7 8 7M6 10v10h12V10',
  check: 'M5 13l4 4L19 7',
  weave: 'M8 3v18M16 3v5M16 12v9M3 8h2M11 8h10M3 16h10M19 16h2',
  list: 'M8 6h13M8 12h13M8 18h13M3 6h.5M3 12h.5M3 18h.5',
  laser: 'M12 2v10M8 12h8M5 20h14M12 16v.5M8.5 15l-1 1M15.5 15l1 1',
  sheet: 'M6 3h9l4 4v14H6zM15 3v4h4',
  gear: 'M12 9a3 3 0 1 0 0 6a3 3 0 0 0 0-6M12 2v3M12 19v3M2 12h3M19 12h3M5 5l2 2M17 17l2 2M19 5l-2 2M7 17l-2 2',
  play: 'M7 4l13 8l-13 8z',
  pause: 'M8 4v16M16 4v16',
  print: 'M7 9V3h10v6M7 17H4V9h16v8h-3M7 14h10v7H7z',
  edit: 'M4 20l1-5L16 4l4 4L9 19z',
  book: 'M4 4h7a2 2 0 0 1 1 1a2 2 0 0 1 1-1h7v15h-7a2 2 0 0 0-1 1a2 2 0 0 0-1-1H4zM12 5v15',
  warn: 'M12 4l9 16H3zM12 10v4M12 17v.5',
} as const;

export type IconName = keyof typeof kPaths;

export function Icon(props: { readonly name: IconName }) {
  return (
    <svg class="icon" viewBox="0 0 24 24" aria-hidden="true">
      <path d={kPaths[props.name]} />
    </svg>
  );
}

export function Logo() {
  return (
    <svg class="logo" viewBox="0 0 32 32" aria-hidden="true">
      <g class="logo-warp">
        <path d="M11 5v22M21 5v22" />
      </g>
      <g class="logo-weft">
        <path d="M5 11h22M5 21h22" />
      </g>
      <g class="logo-warp">
        <path class="logo-over" d="M11 7.5v7M21 17.5v7" />
      </g>
    </svg>
  );
}
