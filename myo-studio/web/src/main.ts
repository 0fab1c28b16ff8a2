import { mount } from 'svelte';
import App from './App.svelte';
import { engineOfThisPage } from './engine/socket';
import { Studio } from './state/studio.svelte';
import './style.css';

mount(App, { target: document.getElementById('app')!, props: { studio: new Studio(engineOfThisPage()) } });
