// What this browser keeps: language, colours, notifications; and which keys do what.

import { useEffect, useState } from 'preact/hooks';

import { getVersion } from '../../api/workshop.ts';
import { type Language, kLanguageNames, kLanguages, t } from '../../messages/messages.ts';
import { askToNotify, canNotify } from '../../state/notify.ts';
import { leave, session } from '../../state/session.ts';
import { changeSettings, kThemes, settings } from '../../state/settings.ts';
import { attempt } from '../../state/store.ts';
import { Panel, Segmented } from '../controls.tsx';
import { SelectField, Tick } from '../fields.tsx';
import { PageTabs } from '../tabs.tsx';

function Notifying() {
  const [denied, setDenied] = useState(canNotify() === 'denied');
  const change = async (wanted: boolean): Promise<void> => {
    const granted = wanted && (await askToNotify());
    setDenied(wanted && !granted);
    changeSettings({ notify: granted });
  };
  return (
    <div>
      <Tick checked={settings.value.notify} onChange={(wanted) => void change(wanted)}>
        {t.settings.notify}
      </Tick>
      <p class="quiet">{denied ? t.settings.notifyDenied : t.settings.notifyHint}</p>
    </div>
  );
}

const kKeys = [
  ['stop', 'Ctrl + .'],
  ['stop', 'Esc Esc'],
  ['turn', '← ↑ → ↓'],
  ['zoom', '+ −'],
  ['guide', '← →'],
  ['jog', '← ↑ → ↓'],
] as const;

function Keys() {
  return (
    <Panel title={t.settings.keys}>
      <dl class="key-list">
        {kKeys.map(([what, keys]) => (
          <div key={`${what}${keys}`}>
            <dt>
              <kbd>{keys}</kbd>
            </dt>
            <dd>{t.settings.keyList[what]}</dd>
          </div>
        ))}
      </dl>
    </Panel>
  );
}

function About() {
  const [version, setVersion] = useState('');
  useEffect(() => void getVersion().then((told) => setVersion(told.version), () => undefined), []);
  const now = session.value;
  return (
    <Panel title={t.settings.about}>
      <p>{t.settings.version(version)}</p>
      <p>
        <a href="/api/v1/openapi.json">{t.settings.api}</a>
      </p>
      {now.state === 'in' && (
        <p class="buttons">
          <span>{t.login.as(now.user, t.people.roles[now.role])}</span>
          <button type="button" class="button small" onClick={() => void attempt(leave)}>
            {t.login.out}
          </button>
        </p>
      )}
    </Panel>
  );
}

export function SettingsPage() {
  const { language, theme } = settings.value;
  const languages = [
    { value: 'auto' as const, label: t.settings.auto },
    ...kLanguages.map((value) => ({ value, label: kLanguageNames[value] })),
  ];
  return (
    <div class="page settings-page">
      <PageTabs label={t.nav.settings} pages={['settings', 'people', 'audit']} />
      <h1>{t.settings.title}</h1>
      <Panel title={t.tabs.settings} class="settings-form">
        <SelectField<Language | 'auto'>
          label={t.settings.language}
          value={language}
          choices={languages}
          onChange={(chosen) => changeSettings({ language: chosen })}
        />
        <div class="field">
          <span>{t.settings.theme}</span>
          <Segmented
            label={t.settings.theme}
            choices={kThemes.map((value) => ({ value, label: t.settings.themes[value] }))}
            value={theme}
            onChange={(chosen) => changeSettings({ theme: chosen })}
          />
        </div>
        <Notifying />
      </Panel>
      <Keys />
      <About />
    </div>
  );
}
