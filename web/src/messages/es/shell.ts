// The frame of every page, in Spanish.

export const shell = {
  title: 'Leafcutter',
  skip: 'Ir al contenido',
  nav: { label: 'Principal', jobs: 'Trabajos', queue: 'Cola', machines: 'Máquinas', materials: 'Material', settings: 'Ajustes' },
  dismiss: 'Descartar',
  save: 'Guardar',
  cancel: 'Cancelar',
  close: 'Cerrar',
  edit: 'Cambiar',
  remove: 'Quitar',
  add: 'Añadir',
  connection: {
    idle: 'Conectando',
    connecting: 'Conectando',
    live: 'En directo',
    waiting: 'Conexión perdida. Reintentando',
    resting: 'En reposo',
  },
  problem: {
    unreachable: 'Leafcutter no responde. ¿Sigue en marcha?',
    stale: 'Esta página es más antigua que el servicio. Vuelva a cargarla.',
    notYet: 'Este servicio no ofrece eso.',
    title: 'No ha funcionado',
    stop: (name: string) => `La PARADA no llegó a ${name}. Use el interruptor de la máquina.`,
  },
  stop: {
    button: 'PARAR',
    all: 'Todas las máquinas',
    none: 'No hay ninguna máquina conectada.',
    hint: 'Ctrl + . o Esc Esc para todas las máquinas',
    sent: (name: string) => `Parada enviada a ${name}.`,
  },
  view: { zoomIn: 'Acercar', zoomOut: 'Alejar' },
};
