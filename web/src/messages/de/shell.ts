// The frame of every page, in German.

export const shell = {
  title: 'Leafcutter',
  skip: 'Zum Inhalt springen',
  nav: { label: 'Hauptmenü', jobs: 'Aufträge', queue: 'Warteschlange', machines: 'Maschinen', materials: 'Material', settings: 'Einstellungen' },
  dismiss: 'Ausblenden',
  save: 'Speichern',
  cancel: 'Abbrechen',
  close: 'Schließen',
  edit: 'Ändern',
  remove: 'Entfernen',
  add: 'Hinzufügen',
  connection: {
    idle: 'Verbinde',
    connecting: 'Verbinde',
    live: 'Live',
    waiting: 'Verbindung verloren. Neuer Versuch',
    resting: 'Ruht',
  },
  problem: {
    unreachable: 'Leafcutter antwortet nicht. Läuft es noch?',
    stale: 'Diese Seite ist älter als der Dienst. Bitte neu laden.',
    notYet: 'Dieser Dienst bietet das nicht an.',
    title: 'Das hat nicht geklappt',
    stop: (name: string) => `STOPP hat ${name} nicht erreicht. Schalter an der Maschine benutzen.`,
  },
  stop: {
    button: 'STOPP',
    all: 'Alle Maschinen',
    none: 'Keine Maschine ist verbunden.',
    hint: 'Strg + . oder Esc Esc stoppt alle Maschinen',
    sent: (name: string) => `Stopp an ${name} gesendet.`,
  },
  view: { zoomIn: 'Vergrößern', zoomOut: 'Verkleinern' },
};
