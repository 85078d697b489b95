// In English.

export const fields = {};
