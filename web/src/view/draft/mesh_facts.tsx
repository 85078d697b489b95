// What a dropped mesh is, and what is wrong with it.

import type { Defects, MeshLook } from '../../mesh/look.ts';
import { count, figure } from '../../lib/format.ts';
import { t } from '../../messages/messages.ts';
import type { Looked } from '../../state/mesh_looks.ts';
import { Icon } from '../icons.tsx';

function defectWords(defects: Defects): readonly string[] {
  const words = t.look.defects;
  return (Object.keys(words) as (keyof Defects)[])
    .filter((name) => defects[name] > 0)
    .map((name) => words[name](count(defects[name])));
}

// In the units it will have: the file's own, or mm.
function size(look: MeshLook, scale: number): string {
  return look.sizeMm.map((side) => figure(side * scale, 4)).join(' × ');
}

// STL repeats every corner; that is no fault of the mesh.
function shownDefects(look: MeshLook, file: string): readonly string[] {
  const isStl = /\.stl$/i.test(file);
  return defectWords(isStl ? { ...look.defects, duplicateVertices: 0 } : look.defects);
}

export function MeshFacts(props: { readonly looked: Looked | undefined; readonly scale: number; readonly file: string }) {
  const { looked, scale, file } = props;
  if (looked === undefined) return null;
  if (looked.state === 'looking') return <p class="quiet">{t.look.looking}</p>;
  if (looked.state === 'unreadable') {
    return (
      <p class="mesh-warn">
        <Icon name="warn" />
        {t.look.unreadable(looked.fault)}
      </p>
    );
  }
  const { look } = looked;
  const defects = shownDefects(look, file);
  const genus = look.genus === null ? '' : t.look.genus(count(look.genus));
  const parts = [t.look.mesh(count(look.vertices), count(look.faces)), t.look.parts(look.components), genus, t.look.loops(look.boundaryLoops)];
  return (
    <div class="mesh-facts">
      <p>
        <strong>{size(look, scale)} mm</strong> · {parts.filter((part) => part !== '').join(' · ')}
      </p>
      {defects.length === 0 ? (
        <p class="mesh-good">
          <Icon name="check" />
          {t.look.sound}
        </p>
      ) : (
        <p class="mesh-warn">
          <Icon name="warn" />
          {defects.join(', ')}
        </p>
      )}
    </div>
  );
}
