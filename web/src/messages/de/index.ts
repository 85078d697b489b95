// Every word the dashboard says, in German.

import type { Messages } from '../en/index.ts';
import { cut } from './cut.ts';
import { draft } from './draft.ts';
import { fields } from './fields.ts';
import { guide } from './guide.ts';
import { jobs } from './jobs.ts';
import { library } from './library.ts';
import { people } from './people.ts';
import { result } from './result.ts';
import { shell } from './shell.ts';

export const de: Messages = { ...shell, ...draft, ...fields, ...jobs, ...result, ...cut, ...guide, ...library, ...people };
