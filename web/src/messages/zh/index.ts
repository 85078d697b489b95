import { en } from '../en/index.ts';
import type { Messages } from '../en/index.ts';

export const zh: Messages = en;
