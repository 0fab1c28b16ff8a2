import { mount } from 'svelte';
import Report from './Report.svelte';
import type { Recorded } from './engine/protocol';
import { RecordedEngine } from './engine/recorded';
import { Studio } from './state/studio.svelte';
import './style.css';

const recorded = JSON.parse(document.getElementById('recorded')!.textContent!) as Recorded;
const studio = new Studio(new RecordedEngine(recorded));
mount(Report, { target: document.getElementById('app')!, props: { studio, recorded } });
