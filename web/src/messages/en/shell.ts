// The frame of every page, in English.

export const shell = {
  title: 'Leafcutter',
  skip: 'Skip to the content',
  nav: { label: 'Main', jobs: 'Jobs', queue: 'Queue', machines: 'Machines', materials: 'Material', settings: 'Settings' },
  dismiss: 'Dismiss',
  save: 'Save',
  cancel: 'Cancel',
  close: 'Close',
  edit: 'Change',
  remove: 'Remove',
  add: 'Add',
  connection: {
    idle: 'Connecting',
    connecting: 'Connecting',
    live: 'Live',
    waiting: 'Connection lost. Trying again',
    resting: 'Asleep',
  },
  problem: {
    unreachable: 'Leafcutter does not answer. Is it still running?',
    stale: 'This page is older than the daemon. Load it again.',
    notYet: 'This daemon does not offer that.',
    title: 'That did not work',
    stop: (name: string) => `STOP did not reach ${name}. Use the switch on the machine.`,
  },
  stop: {
    button: 'STOP',
    all: 'All machines',
    none: 'No machine is connected.',
    hint: 'Ctrl + . or Esc Esc stops every machine',
    sent: (name: string) => `Stop sent to ${name}.`,
  },
  view: { zoomIn: 'Zoom in', zoomOut: 'Zoom out' },
};
