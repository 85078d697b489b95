// Every word the dashboard says, in English. Another language is another folder of this shape.

import { cut } from './cut.ts';
import { draft } from './draft.ts';
import { fields } from './fields.ts';
import { guide } from './guide.ts';
import { jobs } from './jobs.ts';
import { library } from './library.ts';
import { people } from './people.ts';
import { result } from './result.ts';
import { shell } from './shell.ts';

export const en = { ...shell, ...draft, ...fields, ...jobs, ...result, ...cut, ...guide, ...library, ...people };

export type Messages = typeof en;
