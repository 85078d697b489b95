// Line drawings, all on a 24 × 24 grid and in the colour of the text around them.

const kPaths = {
  plus: 'M12 5v14M5 12h14',
  minus: 'M5 12h14',
  fit: 'M4 9V4h5M15 4h5v5M20 15v5h-5M9 20H4v-5',
  close: 'M6 6l12 12M18 6L6 18',
  left: 'M15 5l-7 7 7 7',
  right: 'M9 5l7 7-7 7',
  up: 'M5 15l7-7 7 7',
  down: 'M5 9l7 7 7-7',
  download: 'M12 4v11M7 11l5 5 5-5M5 20h14',
  upload: 'M12 20V8M7 12l5-5 5 5M5 4h14',
  home: 'M4 11l8-7 8 7M6 10v10h12V10',
  check: 'M5 13l4 4L19 7',
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
