// The frame of every page, in French.

export const shell = {
  title: 'Leafcutter',
  skip: 'Aller au contenu',
  nav: { label: 'Principal', jobs: 'Travaux', queue: 'File', machines: 'Machines', materials: 'Matériaux', settings: 'Réglages' },
  dismiss: 'Masquer',
  save: 'Enregistrer',
  cancel: 'Annuler',
  close: 'Fermer',
  edit: 'Modifier',
  remove: 'Supprimer',
  add: 'Ajouter',
  connection: {
    idle: 'Connexion',
    connecting: 'Connexion',
    live: 'En direct',
    waiting: 'Connexion perdue. Nouvel essai',
    resting: 'En veille',
  },
  problem: {
    unreachable: 'Leafcutter ne répond pas. Tourne-t-il encore ?',
    stale: 'Cette page est plus ancienne que le service. Rechargez-la.',
    notYet: 'Ce service ne propose pas cela.',
    title: 'Cela n’a pas marché',
    stop: (name: string) => `L’ARRÊT n’a pas atteint ${name}. Utilisez l’interrupteur de la machine.`,
  },
  stop: {
    button: 'ARRÊT',
    all: 'Toutes les machines',
    none: 'Aucune machine n’est connectée.',
    hint: 'Ctrl + . ou Échap Échap arrête toutes les machines',
    sent: (name: string) => `Arrêt envoyé à ${name}.`,
  },
  view: { zoomIn: 'Agrandir', zoomOut: 'Réduire' },
};
